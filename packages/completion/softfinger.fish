# Completion of softfinger for fish: the program itself says what fits.
function __softfinger_candidates
    set -l words (commandline -opc) (commandline -ct)
    $words[1] complete -- $words[2..] 2>/dev/null
end
complete -c softfinger -a '(__softfinger_candidates)'
