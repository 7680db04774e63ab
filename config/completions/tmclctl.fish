# fish completion for tmclctl: the program itself knows what may stand at the cursor.

function __tmclctl_complete
    set -l words (commandline -opc)
    set -l current (commandline -ct)
    set -l found (tmclctl __complete line -- $words[2..-1] "$current" 2>/dev/null)
    if test "$found[1]" = :files
        __fish_complete_path "$current"
    else
        printf '%s\n' $found
    end
end

complete -c tmclctl -f -a '(__tmclctl_complete)'
