# Completion of surfacectl for bash, by its help texts.  For zsh: run bashcompinit first.
# shellcheck disable=SC2086 # two words

_surfacectl_help() {
    "${COMP_WORDS[0]}" "$@" --help 2>/dev/null
}

# The commands that begin with the words given, without these words.
_surfacectl_commands() {
    _surfacectl_help | sed -n '/^Commands/,/^$/s/^  \([a-z-]*\( [a-z-]*\)\{0,1\}\) .*/\1/p' |
        sed -n "s/^$*//p" | cut -d ' ' -f 1
}

_surfacectl() {
    local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]} i name='' words='' value=''
    COMPREPLY=()
    for ((i = 1; i < COMP_CWORD; i++)); do
        case ${COMP_WORDS[i]} in
        --db | --config | --key | --anchor) ((i++)) ;;
        -*) ;;
        *) name+="${name:+ }${COMP_WORDS[i]}" ;;
        esac
    done
    if [ -z "$(_surfacectl_commands "${name%% *} ")" ]; then
        name=${name%% *} # a command of one word, and its arguments
    else
        name=$(cut -d ' ' -f 1,2 <<<"$name")
    fi
    case $prev in
    -*) value=$(_surfacectl_help $name | sed -n "s/^  \(-., \)\{0,1\}$prev \([A-Za-z|,]*\).*/\2/p") ;;
    esac
    case $value in
    *FILE* | *DIR* | *PATH*) ;;
    *'|'*) words=${value//'|'/ } ;;
    ?*) return ;;
    *)
        if [[ $cur == -* ]]; then
            words=$(_surfacectl_help $name | sed -n 's/^  \(-., \)\{0,1\}\(--[a-z-]*\).*/\2/p')
        elif [[ $name != *' '* ]]; then
            words=$(_surfacectl_commands "$name${name:+ }")
        fi
        ;;
    esac
    if [ -n "$words" ]; then
        mapfile -t COMPREPLY < <(compgen -W "$(sort -u <<<"$words")" -- "$cur")
    else
        mapfile -t COMPREPLY < <(compgen -f -- "$cur")
    fi
}
complete -o filenames -F _surfacectl surfacectl
