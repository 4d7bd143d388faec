# Completion of lagc for fish. `lagc complete` finds the candidates.
function __lagc_complete
    set -l words (commandline -opc)
    set -l current (commandline -ct | string unescape)
    set -l lagc $words[1]
    set -e words[1]
    for line in ($lagc complete $words "$current" 2>/dev/null)
        switch $line
            case ':files'
                __fish_complete_path (string replace -r '^--[a-z-]+=' '' -- $current)
            case ':files *'
                set -l path (string replace -r '^--[a-z-]+=' '' -- $current)
                set -l head (string match -r '^--[a-z-]+=' -- $current)
                set -l suffixes (string split ' ' (string replace ':files ' '' $line))
                for file in $path*
                    if test -d $file
                        echo "$head$file/"
                    else if contains (string replace -r '.*\.' '' -- $file) $suffixes
                        echo "$head$file"
                    end
                end
            case '*'
                echo $line
        end
    end
end
complete -c lagc -f -a '(__lagc_complete)'
