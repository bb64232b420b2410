# Completion of gyrotwin and its programs for bash.
# The table at the end is what the programs say of themselves: see services/runtime/manual.hpp.

# Rig files by name: this host's and the installed ones.
_gyrotwin_rigs() {
  local program folder file
  program=$(readlink -f "$(type -P gyrotwin)")
  for folder in ${GYROTWIN_RIGS:-/etc/gyrotwin/rigs "${program%/bin/*}/share/gyrotwin/rigs"}; do
    for file in "$folder"/*.toml; do
      [ -e "$file" ] && basename "$file" .toml
    done
  done
}

# Values of a type, as --help names it, that begin with what is typed.
_gyrotwin_values() {
  local type=$1 current=$2
  case $type in
    'NAME|FILE') mapfile -t COMPREPLY < <(compgen -W "$(_gyrotwin_rigs)" -- "$current"; compgen -f -- "$current") ;;
    *FILE* | *.html | *.toml | OUT | LOG | PATH) mapfile -t COMPREPLY < <(compgen -f -- "$current") ;;
    FOLDER) mapfile -t COMPREPLY < <(compgen -d -- "$current") ;;
    *'|'*) mapfile -t COMPREPLY < <(compgen -W "${type//|/ }" -- "$current") ;;
  esac
  case $type in *FILE* | *.html | *.toml | OUT | LOG | PATH | FOLDER) compopt -o filenames 2>/dev/null || : ;; esac
}

_gyrotwin() {
  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]}
  local context=${COMP_WORDS[0]##*/} word
  COMPREPLY=()
  for word in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do
    if [ "$context" = gyrotwin ]; then
      context=gyrotwin-$word
    elif [ -n "${_gyrotwin_words[$context $word]+known}" ]; then
      context+=" $word"
    fi
  done

  local here=() names=() arguments=()
  read -ra here <<<"${_gyrotwin_words[$context]-}"
  for word in "${here[@]}"; do
    case $word in
      "$previous"=*) _gyrotwin_values "${word#*=}" "$current"; return ;;
      -*) [[ $current != -* ]] || names+=("${word%%=*}") ;;
      *:) arguments+=("${word%:}") ;;
      *) names+=("$word") ;;
    esac
  done
  if [[ $current != -* ]]; then
    for word in "${arguments[@]}"; do _gyrotwin_values "$word" "$current"; done
  fi
  mapfile -t -O "${#COMPREPLY[@]}" COMPREPLY < <(compgen -W "${names[*]}" -- "$current")
}

declare -gA _gyrotwin_words=()
while IFS=$'\t' read -r _gyrotwin_context _gyrotwin_line; do
  _gyrotwin_words[$_gyrotwin_context]=$_gyrotwin_line
  [[ $_gyrotwin_context == *' '* ]] || complete -F _gyrotwin "$_gyrotwin_context"
done <<'END'
