#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Makes a release: checks, tests, builds, dates the changelog, commits and tags. Pushes nothing.
#   scripts/release.sh [--dry-run] [--skip-tests REASON] VERSION
# --dry-run            only check, and print the commit and the tag that would be made; nothing is built or changed
# --skip-tests REASON  don't run ./test.sh; the reason is recorded in the messages of the commit and the tag
# Exit status: 0 done, or ready in a dry run; 1 a check failed; 2 wrong usage.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

usage() {
    sed -n '1d; /^# SPDX/d; /^#/!q; s/^# \{0,1\}//p' "scripts/${BASH_SOURCE[0]##*/}" >&2
    exit 2
}

dry_run='' skip_reason='' version=''
while [ $# -gt 0 ]; do
    case $1 in
        --dry-run) dry_run=1 ;;
        --skip-tests)
            skip_reason=${2:-}
            [ -n "$skip_reason" ] || usage
            shift
            ;;
        -*) usage ;;
        *)
            [ -z "$version" ] || usage
            version=$1
            ;;
    esac
    shift
done
[[ $version =~ ^(0|[1-9][0-9]*)\.(0|[1-9][0-9]*)\.(0|[1-9][0-9]*)$ ]] || usage

tag=v$version
failures=0
# check TEXT COMMAND...: prints whether the command succeeds.
check() {
    local text=$1
    shift
    if "$@"; then
        echo "ok      $text"
    else
        echo "FAILED  $text"
        failures=$((failures + 1))
    fi
}
stop_on_failures() {
    if [ "$failures" -gt 0 ]; then
        echo "release: $failures of the checks above failed; nothing was released" >&2
        exit 1
    fi
}

is_clean() { [ -z "$(git status --porcelain)" ]; }
is_on_main() { [ "$(git symbolic-ref --quiet --short HEAD)" = main ]; }
has_no_tag() { ! git rev-parse --quiet --verify "refs/tags/$tag" >/dev/null; }
cmake_version() { sed -n 's/^project(fathom VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt; }
is_version_of_cmake() { [ "$(cmake_version)" = "$version" ]; }

# The heading of this version; this script replaces "unreleased" by the date of the release.
heading="## [$version] - unreleased"
has_heading() { [ "$(grep -cFx "$heading" CHANGELOG.md)" = 1 ]; }
# Prints the changelog's section of this version: the lines up to the next version's heading, without blank lines at
# both ends.
section() {
    awk -v heading="$heading" '
        /^## / { inside = $0 == heading; next }
        /^\[[^]]*\]: / { next }
        inside && (NF || text) { text = text $0 "\n" }
        END { sub(/\n+$/, "", text); print text }' CHANGELOG.md
}
has_text() { [ -n "$(section)" ]; }
# Changes after this version need a heading of their own, above it.
has_unreleased() { [ "$(grep -n '^## ' CHANGELOG.md | head -n 1 | cut -d : -f 2)" = '## [Unreleased]' ]; }
# Changes under "Unreleased" would be in the release, but in no version of the changelog.
has_nothing_unreleased() {
    [ -z "$(awk '/^## / { inside = $0 == "## [Unreleased]"; next } inside && NF' CHANGELOG.md)" ]
}

message() {
    printf 'Fathom %s\n\n' "$version"
    section
    if [ -n "$skip_reason" ]; then printf '\nTests were not run: %s\n' "$skip_reason"; fi
}
commit_message() {
    printf 'Release %s\n' "$version"
    if [ -n "$skip_reason" ]; then printf '\nTests were not run: %s\n' "$skip_reason"; fi
}
dated_changelog() {
    sed "s/^## \[${version//./\\.}\] - unreleased\$/## [$version] - $(date --utc +%Y-%m-%d)/" CHANGELOG.md
}

is_version_of_program() { [ "$(build/release/bin/fathom --version)" = "fathom $version" ]; }
# docs/cli.md must name each option that --help prints. (A test checks that the file is exactly the generated one.)
has_documented_options() {
    local command missing=''
    [ -f docs/cli.md ] || {
        echo "        docs/cli.md is missing"
        return 1
    }
    for command in render merge info convert view submit status version completion man; do
        missing+=$(build/release/bin/fathom "$command" --help | grep -oE '^ +(-[A-Za-z],)?--[a-z][a-z-]*' |
            grep -oE -- '--[a-z-]+' | sort -u | while read -r option; do
            grep -qE -- "(^|[^a-z-])$option([^a-z-]|\$)" docs/cli.md || printf ' %s %s\n' "$command" "$option"
        done)
    done
    [ -z "$missing" ] || {
        echo "        docs/cli.md lacks:$missing"
        return 1
    }
}

check "on branch main" is_on_main
check "no uncommitted changes" is_clean
check "no tag $tag yet" has_no_tag
check "CMakeLists.txt says version $version (found: $(cmake_version))" is_version_of_cmake
check "CHANGELOG.md begins with ## [Unreleased]" has_unreleased
check "nothing stands under ## [Unreleased]" has_nothing_unreleased
check "CHANGELOG.md has the heading: $heading" has_heading
check "that section of CHANGELOG.md has text" has_text
check "docs/cli.md exists" test -f docs/cli.md

if [ -n "$dry_run" ]; then
    stop_on_failures
    if [ -n "$skip_reason" ]; then echo "would skip ./test.sh: $skip_reason"; else echo "would run ./test.sh"; fi
    echo "would build build/release, and compare docs/cli.md with --help"
    echo "would change CHANGELOG.md:"
    diff <(cat CHANGELOG.md) <(dated_changelog) | sed 's/^/    /' || true
    echo "would commit:"
    commit_message | sed 's/^/    /'
    echo "would tag $tag:"
    message | sed 's/^/    /'
    exit 0
fi
stop_on_failures

# shellcheck source=scripts/setup.sh
source scripts/setup.sh
if [ -n "$skip_reason" ]; then
    echo "skipped ./test.sh: $skip_reason"
else
    check "./test.sh" ./test.sh
    stop_on_failures
fi
install_missing "${packages_to_build[@]}"
build_preset release
check "the program says version $version" is_version_of_program
check "docs/cli.md names every option of --help" has_documented_options
check "tests and build left no uncommitted changes" is_clean
stop_on_failures

# The message is made now, while the section still has the heading by which it is found.
tag_message=$(message)
changelog=$(dated_changelog)
printf '%s\n' "$changelog" >CHANGELOG.md
commit_message | git commit --quiet --file=- -- CHANGELOG.md
# Cleanup is verbatim because git would remove headings as comments.
git tag --annotate --cleanup=verbatim --file=- "$tag" <<<"$tag_message"
echo "committed and tagged $tag; to publish it:"
echo "    git push origin main $tag"
