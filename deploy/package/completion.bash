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

# Those of the words that begin with what is typed. (compgen -W would expand them once more.)
_gyrotwin_offer() {
  local current=$1 word
  shift
  for word; do [[ $word != "$current"* ]] || COMPREPLY+=("$word"); done
}

# Values of a type, as --help names it, that begin with what is typed.
_gyrotwin_values() {
  local type=$1 current=$2 rigs=() words=()
  case $type in
    'NAME|FILE')
      mapfile -t COMPREPLY < <(compgen -f -- "$current")
      mapfile -t rigs < <(_gyrotwin_rigs)
      _gyrotwin_offer "$current" "${rigs[@]}"
      ;;
    *FILE* | *.html | *.toml | OUT | LOG | PATH) mapfile -t COMPREPLY < <(compgen -f -- "$current") ;;
    FOLDER) mapfile -t COMPREPLY < <(compgen -d -- "$current") ;;
    *'|'*)
      IFS='|' read -ra words <<<"$type"
      _gyrotwin_offer "$current" "${words[@]}"
      ;;
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
  _gyrotwin_offer "$current" "${names[@]}"
}

declare -gA _gyrotwin_words=()
while IFS=$'\t' read -r _gyrotwin_context _gyrotwin_line; do
  _gyrotwin_words[$_gyrotwin_context]=$_gyrotwin_line
  [[ $_gyrotwin_context == *' '* ]] || complete -F _gyrotwin "$_gyrotwin_context"
done <<'END'
