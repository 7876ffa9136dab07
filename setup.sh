# Set the project up and put cdlc on the PATH of this shell; in the root of the repository:
#
#     . ./setup.sh
#
# CDLC_EXTRAS names the extras to install, "planners verify view examples" by default. For sh, bash, dash and zsh.
# shellcheck shell=sh source=/dev/null

# A subshell, so that nothing but its exit status reaches the user's shell.
(
    if [ ! -f ./tools/environment.py ]; then
        printf '%s\n' 'error: run ". ./setup.sh" in the root of the cdlc repository' >&2
        exit 1
    fi
    check='import sys; sys.version_info >= (3, 11) or sys.exit(1); print(sys.executable)'
    for python in python3 python3.13 python3.12 python3.11 python; do
        # From here on the program itself: the name may be that of a slow script that looks for it.
        if program=$("$python" -c "$check" 2>/dev/null </dev/null); then
            exec "$program" ./tools/environment.py "${CDLC_EXTRAS:-planners verify view examples}"
        fi
    done
    printf '%s\n' 'error: cdlc needs Python 3.11 or later, and there is none on the PATH' >&2
    exit 1
) && case ${ZSH_EVAL_CONTEXT-}/${0##*/} in
    *:file*/*) . ./.venv/bin/activate ;; # sourced by zsh, which then calls this file $0
    */setup.sh) printf '%s\n' '.venv is ready; to put cdlc on the PATH: . ./setup.sh' >&2 ;;
    *) . ./.venv/bin/activate ;;
esac
