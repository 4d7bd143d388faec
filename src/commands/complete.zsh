#compdef lagc
# Completion of lagc for zsh. `lagc complete` finds the candidates.
_lagc() {
  local line name
  local -a open open_shown whole whole_shown
  for line in "${(@f)$("${words[1]}" complete "${(@Q)words[2,CURRENT-1]}" "${(Q)PREFIX}" 2>/dev/null)}"; do
    name=${line%%$'\t'*}
    case $line in
      '') ;;
      :files)
        compset -P '--[a-z-]#='
        _files
        ;;
      :files*)
        compset -P '--[a-z-]#='
        _files -g "*.(${${name#:files }// /|})(-.)"
        ;;
      *[=\(\[]$'\t'*) open+=("$name") open_shown+=("$name  ${line#*$'\t'}") ;;
      *) whole+=("$name") whole_shown+=("$name  ${line#*$'\t'}") ;;
    esac
  done
  (($#whole)) && compadd -l -d whole_shown -a whole
  (($#open)) && compadd -S '' -l -d open_shown -a open
  return 0
}
if [[ $funcstack[1] == _lagc ]]; then _lagc "$@"; else compdef _lagc lagc; fi
