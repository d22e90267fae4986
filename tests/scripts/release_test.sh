#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Tests scripts/release.sh in a scratch repository: each check, the dry run, and a release with a fake build and fake tests.
#   release_test.sh ROOT_OF_THE_PROJECT
# Exit status 77 (skipped) without git.
set -euo pipefail
command -v git >/dev/null || {
    echo "git is not installed: skipped"
    exit 77
}
root=$1
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
export GIT_CONFIG_GLOBAL=/dev/null GIT_CONFIG_NOSYSTEM=1
export GIT_AUTHOR_NAME=tester GIT_AUTHOR_EMAIL=tester@example.com GIT_COMMITTER_NAME=tester GIT_COMMITTER_EMAIL=tester@example.com
# Syncing files to disk is disabled for speed.
export GIT_CONFIG_COUNT=1 GIT_CONFIG_KEY_0=core.fsync GIT_CONFIG_VALUE_0=none
unset GIT_DIR GIT_WORK_TREE GIT_INDEX_FILE
repository=$place/repository log=$place/log
failures=0

# make_repository: a clean repository, ready to release 1.2.3. It is copied, because creating one takes git long.
make_repository() {
    rm -rf "$repository"
    cp -r "$place/template" "$repository"
    cd "$repository"
}
make_template() {
    repository=$place/template
    mkdir -p "$repository/scripts" "$repository/docs" "$repository/program"
    cd "$repository"
    git init --quiet --initial-branch=main
    cp "$root/scripts/release.sh" scripts/
    echo 'project(fathom VERSION 1.2.3 LANGUAGES CXX)' >CMakeLists.txt
    printf '%s\n' '# Changelog' '' '## [Unreleased]' '' '## [1.2.3] - unreleased' '' '### Added' '- A sun.' '' \
        '## [1.2.2] - 2026-01-01' '- A moon.' >CHANGELOG.md
    echo 'Options: --size, --spp, --json.' >docs/cli.md
    echo /build/ >.gitignore
    # A fake program that prints its version and the help of two commands.
    cat >program/fathom <<'PROGRAM'
#!/bin/sh
case "$*" in
    --version) echo fathom 1.2.3 ;;
    "render --help") printf '  -s,--size WxH    size\n  --spp N    samples, unlike --time\n' ;;
    "info --help") printf '  --json    as JSON\n' ;;
esac
PROGRAM
    # The build and the tests are fakes.
    cat >scripts/setup.sh <<'SETUP'
packages_to_build=(clang)
install_missing() { :; }
build_preset() { mkdir -p "build/$1/bin" && cp program/fathom "build/$1/bin/fathom"; }
SETUP
    printf '#!/bin/sh\ntouch build/tested\n' >test.sh
    mkdir build
    chmod +x scripts/release.sh test.sh program/fathom
    commit
    repository=$place/repository
}
commit() { git add --all && git commit --quiet --message "$(date +%N)"; }
state() { git rev-parse HEAD && git status --porcelain && git tag; }

# expect STATUS CASE [OPTION]...: runs release.sh and checks its exit status.
expect() {
    local status=$1 case=$2 found=0
    shift 2
    scripts/release.sh "$@" >"$log" 2>&1 </dev/null || found=$?
    if [ "$found" != "$status" ]; then fail_case "$case: expected exit status $status, found $found" <"$log"; fi
}
fail_case() {
    echo "FAILED: $1"
    sed 's/^/    /'
    failures=$((failures + 1))
}
# expect_text CASE TEXT: checks that the output contains this text.
expect_text() {
    grep -qF -- "$2" "$log" || fail_case "$1: expected the text '$2'" <"$log"
}
expect_equal() {
    if [ "$2" != "$3" ]; then fail_case "$1" < <(printf 'expected %s\nfound    %s\n' "$2" "$3"); fi
}
# refused CASE TEXT [OPTION]...: checks that nothing is released and a line says why, with and without --dry-run.
refused() {
    local case=$1 text=$2 before dry_run
    shift 2
    before=$(state)
    for dry_run in --dry-run ''; do
        expect 1 "$case" ${dry_run:+"$dry_run"} "$@" 1.2.3
        expect_text "$case" "FAILED  $text"
        expect_equal "$case: the repository stays as it was" "$before" "$(state)"
    done
    if [ -e build/tested ]; then fail_case "$case: tests ran before all cheap checks were done" <"$log"; fi
}

make_template
make_repository
before=$(state)
expect 0 "dry run" --dry-run 1.2.3
expect_text "dry run" "would tag v1.2.3"
expect_text "dry run" "would run ./test.sh"
expect_text "dry run" "> ## [1.2.3] - $(date --utc +%Y-)"
expect_text "dry run" "- A sun."
expect_equal "a dry run changes nothing" "$before" "$(state)"
expect_equal "a dry run builds nothing" "" "$(ls build)"
if grep -q "moon" "$log"; then fail_case "the tag's message has another version's section" <"$log"; fi

for wrong in "" 1.2 v1.2.3 1.2.3-rc1 01.2.3 --wrong "1.2.3 1.2.4" "--skip-tests" ; do
    # shellcheck disable=SC2086  # several words
    expect 2 "wrong usage: $wrong" --dry-run $wrong
done

echo more >>CHANGELOG.md
refused "uncommitted changes" "no uncommitted changes"
make_repository
touch new-file
refused "an untracked file" "no uncommitted changes"
make_repository
git checkout --quiet -b other
refused "another branch" "on branch main"
make_repository
git checkout --quiet --detach
refused "no branch" "on branch main"
make_repository
git tag v1.2.3
refused "a tag that exists" "no tag v1.2.3 yet"
make_repository
sed -i 's/1\.2\.3/1.2.4/' CMakeLists.txt
commit
refused "another version in CMakeLists.txt" "CMakeLists.txt says version 1.2.3 (found: 1.2.4)"
make_repository
sed -i 's/\[1\.2\.3\]/[1.3.0]/' CHANGELOG.md
commit
refused "no section in the changelog" "CHANGELOG.md has the heading"
make_repository
sed -i 's/- unreleased/- 2026-02-02/' CHANGELOG.md
commit
refused "a section that has a date" "CHANGELOG.md has the heading"
make_repository
sed -i '/### Added/d; /A sun/d' CHANGELOG.md
commit
refused "an empty section" "that section of CHANGELOG.md has text"
make_repository
sed -i 's/^## \[Unreleased\]/&\n- A star./' CHANGELOG.md
commit
refused "changes under Unreleased" "nothing stands under ## [Unreleased]"
make_repository
sed -i '/Unreleased/d' CHANGELOG.md
commit
refused "no heading for what comes after" "CHANGELOG.md begins with ## [Unreleased]"
make_repository
git rm --quiet docs/cli.md
commit
refused "no docs/cli.md" "docs/cli.md exists"

# These failures appear only after the tests and the build.
make_repository
echo '#!/bin/false' >test.sh
commit
before=$(state)
expect 1 "tests fail" 1.2.3
expect_text "tests fail" "FAILED  ./test.sh"
expect_equal "tests fail" "$before" "$(state)"
make_repository
sed -i 's/fathom 1\.2\.3/fathom 1.2.2/' program/fathom
commit
expect 1 "the program has another version" 1.2.3
expect_text "the program has another version" "FAILED  the program says version 1.2.3"
make_repository
sed -i 's/--spp/--spps/' docs/cli.md
commit
before=$(state)
expect 1 "an option is not documented" 1.2.3
expect_text "an option is not documented" "docs/cli.md lacks: render --spp"
expect_equal "an option is not documented" "$before" "$(state)"
make_repository
printf '#!/bin/sh\ntouch left-behind\n' >test.sh
commit
expect 1 "tests leave a file behind" 1.2.3
expect_text "tests leave a file behind" "FAILED  tests and build left no uncommitted changes"

make_repository
expect 0 "a release" 1.2.3
expect_text "a release" "git push origin main v1.2.3"
expect_equal "tests ran" build/tested "$(ls build/tested)"
expect_equal "the commit" "Release 1.2.3" "$(git log -1 --format=%B)"
expect_equal "it changes one file" CHANGELOG.md "$(git diff --name-only HEAD~)"
expect_equal "it changes one line" "1	1	CHANGELOG.md" "$(git diff --numstat HEAD~)"
expect_equal "the tag is annotated" tag "$(git cat-file -t v1.2.3)"
expect_equal "the tag is of the commit" "$(git rev-parse HEAD)" "$(git rev-parse 'v1.2.3^{commit}')"
expect_equal "the tag's message" "$(printf 'Fathom 1.2.3\n\n### Added\n- A sun.')" "$(git tag --list --format='%(contents)' v1.2.3)"
expect_equal "nothing is left to commit" "" "$(git status --porcelain)"
grep -qE '^## \[1\.2\.3\] - [0-9]{4}-[0-9]{2}-[0-9]{2}$' CHANGELOG.md || fail_case "the changelog has the date" <CHANGELOG.md
expect 1 "the release again" 1.2.3

make_repository
expect 0 "a release without tests" --skip-tests "the machine burns" 1.2.3
if [ -e build/tested ]; then fail_case "tests ran" <"$log"; fi
expect_equal "the reason in the commit" "Tests were not run: the machine burns" "$(git log -1 --format=%b)"
git tag --list --format='%(contents)' v1.2.3 >"$log"
expect_text "the reason in the tag" "Tests were not run: the machine burns"

[ "$failures" -eq 0 ] || exit 1
echo "all cases passed"
