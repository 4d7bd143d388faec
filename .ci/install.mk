# `make install`, `make uninstall`, `make dist`. Included by the Makefile.

# ---- installing -------------------------------------------------------------------------------------
MODELS := $(wildcard models/*.lag models/*.csv)
PC     := $(BUILD)/liblag.pc
# Where lagc.py goes; `make install PYTHONDIR=...` puts it where a Python looks.
PYTHONDIR ?= $(PREFIX)/share/lagc/python
HEADERS := $(API_HEAD) $(ANY_HEAD)
FILL_IN = sed -e 's|@PREFIX@|$(PREFIX)|' -e 's|@LIBDIR@|$(call below,$${prefix}/,$(LIBDIR))|' \
            -e 's|@INCLUDEDIR@|$(call below,$${prefix}/,$(INCLUDEDIR))|' -e 's|@VERSION@|$(VERSION)|'
# The same for CMake: from its folder LIBDIR/cmake/lagc up to PREFIX, where LIBDIR is below it.
LIB_BELOW := $(call below,,$(LIBDIR))
SPACE := $(if ,) $(if ,)
TO_PREFIX := $(if $(filter /%,$(LIB_BELOW)),$(PREFIX),$${CMAKE_CURRENT_LIST_DIR}/../..$(subst $(SPACE),,$(patsubst %,/..,$(subst /, ,$(LIB_BELOW)))))
CMAKE_FILL_IN = sed -e 's|@CMAKE_PREFIX@|$(TO_PREFIX)|' -e 's|@LIBDIR@|$(call below,$${_lagc_prefix}/,$(LIBDIR))|' \
            -e 's|@INCLUDEDIR@|$(call below,$${_lagc_prefix}/,$(INCLUDEDIR))|' -e 's|@VERSION@|$(VERSION)|' -e 's|@SOVERSION@|$(SOVERSION)|g'
COMPLETIONS := bash-completion/completions zsh/site-functions fish/vendor_completions.d

install: all precisions
	install -d '$(DESTDIR)$(PREFIX)/bin' '$(DESTDIR)$(LIBDIR)/pkgconfig' '$(DESTDIR)$(INCLUDEDIR)' \
	  '$(DESTDIR)$(PREFIX)/share/lagc/models/lib' '$(DESTDIR)$(PYTHONDIR)' '$(DESTDIR)$(PREFIX)/share/man/man1' '$(DESTDIR)$(PREFIX)/share/doc/lagc' \
	  $(COMPLETIONS:%='$(DESTDIR)$(PREFIX)/share/%')
	install -m 755 $(BUILD)/lagc$(EXE) '$(DESTDIR)$(PREFIX)/bin'
	install -m 755 $(BUILD)/lag-run$(EXE) '$(DESTDIR)$(LIBDIR)'
	for m in $(wildcard $(BUILD)/lag.wasm $(BUILD)/lagc.wasm.gz); do install -m 644 $$m '$(DESTDIR)$(LIBDIR)'; done
	install -m 644 $(LIBLAG) $(LIBLAG_MORE) $(PARTS:%=$(BUILD)/liblag_%.libs) '$(DESTDIR)$(LIBDIR)'
ifneq ($(DYNAMIC),)
	install -m 755 $(LIBLAG_SO) '$(DESTDIR)$(LIBDIR)'
	ln -sfn liblag.so.$(SOVERSION) '$(DESTDIR)$(LIBDIR)/liblag.so'
endif
	for p in $(PRECISIONS); do install -d "$(DESTDIR)$(LIBDIR)/lag-$$p" && \
	  install -m 644 $(BUILD)/lag-$$p/*.h "$(DESTDIR)$(LIBDIR)/lag-$$p" || exit 1; done
	install -m 644 $(HEADERS:%=runtime/include/%) '$(DESTDIR)$(INCLUDEDIR)'
	$(FILL_IN) runtime/liblag.pc.in >$(PC)
	install -m 644 $(PC) '$(DESTDIR)$(LIBDIR)/pkgconfig'
	install -d '$(DESTDIR)$(LIBDIR)/cmake/lagc'
	for f in lagcConfig lagcConfigVersion; do $(CMAKE_FILL_IN) runtime/$$f.cmake.in >$(BUILD)/$$f.cmake && \
	  install -m 644 $(BUILD)/$$f.cmake '$(DESTDIR)$(LIBDIR)/cmake/lagc' || exit 1; done
ifneq ($(GSL),)
	$(FILL_IN) runtime/gsl/liblag_gsl.pc.in >$(PC:.pc=_gsl.pc)
	install -m 644 $(PC:.pc=_gsl.pc) '$(DESTDIR)$(LIBDIR)/pkgconfig'
endif
	install -m 644 $(MODELS) '$(DESTDIR)$(PREFIX)/share/lagc/models'
	install -m 644 $(wildcard models/lib/*.lag models/lib/*.csv models/lib/*.json) '$(DESTDIR)$(PREFIX)/share/lagc/models/lib'
	install -m 644 runtime/python/lagc.py '$(DESTDIR)$(PYTHONDIR)'
	install -m 644 runtime/matlab/lagc_mex.c '$(DESTDIR)$(PREFIX)/share/lagc'
	install -m 644 grammar/lag.tmLanguage.json '$(DESTDIR)$(PREFIX)/share/lagc'
	if $(BUILD)/lagc$(EXE) manpage >$(BUILD)/lagc.1; then install -m 644 $(BUILD)/lagc.1 '$(DESTDIR)$(PREFIX)/share/man/man1'; \
	else echo 'no man page: $(BUILD)/lagc$(EXE), which writes it, does not run on this machine'; fi
	install -m 644 src/commands/complete.bash '$(DESTDIR)$(PREFIX)/share/bash-completion/completions/lagc'
	install -m 644 src/commands/complete.zsh '$(DESTDIR)$(PREFIX)/share/zsh/site-functions/_lagc'
	install -m 644 src/commands/complete.fish '$(DESTDIR)$(PREFIX)/share/fish/vendor_completions.d/lagc.fish'
	install -m 644 LICENSE README.md '$(DESTDIR)$(PREFIX)/share/doc/lagc'

# Removes what install puts there, and the folders that are lagc's own.
uninstall:
	cd '$(DESTDIR)$(PREFIX)' && rm -f bin/lagc bin/lagc.exe share/man/man1/lagc.1 share/bash-completion/completions/lagc \
	  share/zsh/site-functions/_lagc share/fish/vendor_completions.d/lagc.fish && rm -rf share/lagc share/doc/lagc
	rm -f '$(DESTDIR)$(PYTHONDIR)/lagc.py'
	cd '$(DESTDIR)$(LIBDIR)' && rm -f lag-run lag-run.exe lag.wasm lagc.wasm.gz liblag.so liblag.so.[0-9]* liblag.a liblag_gsl.a liblag_png.a liblag_png.libs liblag_hdf5.a liblag_hdf5.libs liblag_mpi.a liblag_mpi.libs liblag_long.a liblag_quad.a pkgconfig/liblag.pc pkgconfig/liblag_gsl.pc && \
	  rm -rf lag-long lag-quad cmake/lagc
	cd '$(DESTDIR)$(INCLUDEDIR)' && rm -f $(HEADERS)

# ---- a package for Debian ----
# build/lagc_VERSION_ARCH.deb, of what is installed on this machine; lagc.py goes where Debian's Python looks.
DEB_ROOT := $(BUILD)/deb
deb:
	@command -v dpkg-deb >/dev/null || { echo 'make deb needs dpkg-deb: Debian, or apt install dpkg'; exit 1; }
	rm -rf $(DEB_ROOT)
	$(MAKE) install PREFIX=/usr LIBDIR=/usr/lib INCLUDEDIR=/usr/include PYTHONDIR=/usr/lib/python3/dist-packages DESTDIR='$(abspath $(DEB_ROOT))' PRECISIONS='$(PRECISIONS)'
	install -d $(DEB_ROOT)/DEBIAN
	needs=$$(for so in $$(ldd $(BUILD)/lagc $(BUILD)/lag-run | sed -n 's/.* => \(\/[^ ]*\) .*/\1/p' | sort -u); do \
	  dpkg -S "*$$so" | sed -n '1s/:.*//p'; done | sort -u | paste -sd , -); \
	printf '%s\n' 'Package: lagc' 'Version: $(VERSION)' "Architecture: $$(dpkg --print-architecture)" 'Section: science' \
	  'Maintainer: the lagc project <lagc@localhost>' "Depends: $$needs" \
	  'Recommends: gcc, libc6-dev' 'Suggests: python3-numpy' 'Description: Lagrangians as text, compiled to C' \
	  ' Derives equations of motion, checks them, simulates them.' >$(DEB_ROOT)/DEBIAN/control
	dpkg-deb --build --root-owner-group $(DEB_ROOT) $(BUILD)

# ---- a release ----
# The files of the last commit as lagc-VERSION.tar.gz, the same bytes wherever it is made: names in order, no dates but the commit's, no owners.
DIST := $(BUILD)/lagc-$(VERSION).tar.gz
dist:
	@git rev-parse --verify -q HEAD >/dev/null || { echo 'make dist packs the last commit: a git repository is needed'; exit 1; }
	@mkdir -p $(BUILD)
	git -c tar.umask=0022 archive --format=tar --prefix=lagc-$(VERSION)/ HEAD | gzip -9n >$(DIST).part
	@mv $(DIST).part $(DIST)
	@sha256sum $(DIST)
