# Completion for bash: the options that a program's own --help lists, else file names.
_film()
{
    local word=${COMP_WORDS[COMP_CWORD]}
    COMPREPLY=()
    [[ $word != -* ]] && return
    mapfile -t COMPREPLY < <(compgen -W "$("$1" --help 2>/dev/null | grep -oE -- '--[a-z][a-z-]+' | sort -u)" -- "$word")
}
complete -o default -F _film findgrains tracker contacts forces simulate render report calibration scene
