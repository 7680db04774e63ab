# fish completion for tmclsim, tmcld and tmcld-mqtt: the options that their help lists.

function __tmcl_options
    $argv[1] --help 2>/dev/null | string match -ra -- '--[a-z][a-z-]*'
end

for program in tmclsim tmcld tmcld-mqtt
    complete -c $program -a "(__tmcl_options $program)" -n 'string match -q -- "-*" (commandline -ct)'
end
complete -c tmclsim -l module -x -a '(tmclctl __complete models 2>/dev/null)'
