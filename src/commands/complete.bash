# Completion of lagc for bash. `lagc complete` finds the candidates; this script joins and quotes words.
_lagc() {
  local word raw=${COMP_WORDS[COMP_CWORD]} quote= full= split= n=0 i suffix
  local -a words=() found=()
  # bash breaks words at `=`; lagc has them whole
  for ((i = 1; i <= COMP_CWORD; i++)); do
    word=${COMP_WORDS[i]}
    if ((n)) && [[ $word == =* || ${words[n - 1]} == *= ]]; then
      words[n - 1]+=$word
      split=1
    else
      words[n]=$word
      ((++n))
      split=
    fi
  done
  for ((i = 0; i < n; i++)); do
    word=${words[i]}
    quote=
    if [[ $word == [\"\']* ]]; then
      quote=${word:0:1}
      word=${word#?}
      word=${word%"$quote"}
    else
      word=${word//\\/}
      [[ $word == "~/"* ]] && word=$HOME/${word:2}
    fi
    words[i]=$word
  done
  full=${words[n - 1]}
  # the part of the word before the part that bash replaces
  local head=
  [[ $split && -z $quote ]] && head=${full%="${full##*=}"}=
  COMPREPLY=()
  while IFS=$'\t' read -r word _; do
    case $word in
      :files*)
        compopt -o filenames 2>/dev/null
        while IFS= read -r i; do
          [[ -d $i ]] && found+=("$i")
          [[ $word == :files && ! -d $i ]] && found+=("$i")
          for suffix in ${word#:files}; do [[ -f $i && $i == *."$suffix" ]] && found+=("$i"); done
        done < <(compgen -f -- "${full#"$head"}")
        ;;
      *)
        word=${word#"$head"}
        [[ $quote ]] || printf -v word %q "$word"
        found+=("$word")
        ;;
    esac
  done < <("$1" complete "${words[@]}" 2>/dev/null)
  COMPREPLY=("${found[@]}")
  [[ ${#found[@]} == 1 && ${found[0]} == *[=\(\[] ]] && compopt -o nospace 2>/dev/null
  return 0
}
complete -F _lagc lagc
