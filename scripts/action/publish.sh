#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Step of action.yml: pushes the images to a branch, since summaries of GitHub show only images that have an address.
#
# FATHOM_OUTPUT      folder with the images
# FATHOM_BRANCH      branch; each run adds a folder to it, named by the number of the run and of the attempt
# GITHUB_WORKSPACE   a clone with a remote `origin` that may be pushed to
# GITHUB_OUTPUT      gets url=ADDRESS, below which the images are
set -euo pipefail
folder=$GITHUB_RUN_ID-${GITHUB_RUN_ATTEMPT:-1}
images=$(realpath "$FATHOM_OUTPUT")
work=$(mktemp -d)
cd "$GITHUB_WORKSPACE"
trap 'rm -rf "$work"; git worktree prune' EXIT
for attempt in 1 2 3; do
  if git fetch --quiet --depth 1 origin "refs/heads/$FATHOM_BRANCH" 2> /dev/null; then
    git worktree add --quiet --detach "$work/tree" FETCH_HEAD
  else
    git worktree add --quiet --detach "$work/tree"
    git -C "$work/tree" checkout --quiet --orphan "fathom-images-$folder"
    git -C "$work/tree" rm -rfq --ignore-unmatch .
  fi
  mkdir -p "$work/tree/$folder"
  cp -r "$images"/. "$work/tree/$folder"
  git -C "$work/tree" add --force "$folder"
  git -C "$work/tree" -c user.name="github-actions[bot]" \
    -c user.email="41898282+github-actions[bot]@users.noreply.github.com" commit --quiet -m "Images of run $folder"
  commit=$(git -C "$work/tree" rev-parse HEAD)
  git -C "$work/tree" checkout --quiet --detach
  git branch --quiet -D "fathom-images-$folder" 2> /dev/null || true
  if git -C "$work/tree" push --quiet origin "HEAD:refs/heads/$FATHOM_BRANCH"; then
    echo "url=$GITHUB_SERVER_URL/$GITHUB_REPOSITORY/raw/$commit/$folder" >> "$GITHUB_OUTPUT"
    exit 0
  fi
  # Another run has pushed in between.
  echo "attempt $attempt to push to $FATHOM_BRANCH failed" >&2
  git worktree remove --force "$work/tree"
done
echo "the images can't be pushed to $FATHOM_BRANCH: does the job have the permission contents: write?" >&2
exit 1
