#!/bin/sh
# Five models, by every command, with a compiler and a runtime under sanitizers. long_sanitized.sh has all of the gallery.
. tests/exec/lib_sanitized.sh
for name in double_pendulum slider_crank bouncing_ball free_body fput; do
  empty "$name" "$(every_command "models/$name.lag")"
done
tap_end
