// Files that are either there in whole or not at all.
#pragma once

#include <cstddef>
#include <string>

namespace gradus {

/// Replaces the file `path` by `size` bytes of `bytes`: they go to a temporary file in the same folder, are flushed to
/// the disk, and take the name by a rename, so that a reader sees the old file or the new one and never a part. A
/// symbolic link is followed. On failure the temporary file is removed and the old file stays as it was.
/// Throws Error(ExitCode::output) with the reason that the system gives.
void write_file_atomically(const std::string &path, const void *bytes, std::size_t size);

/// Throws Error(ExitCode::output) where write_file_atomically(path) would fail for its folder or its name: a folder
/// that is missing or not writable, a path that is a folder or a device. Leaves nothing behind, and removes what runs
/// that were killed left in that folder: temporary files that no process holds a lock of. A disk may still fill up
/// later.
void check_writable(const std::string &path);

/// The file that write_file_atomically(path) would replace: absolute, links followed. Throws Error(ExitCode::output)
/// like check_writable().
std::string written_file(const std::string &path);

} // namespace gradus
