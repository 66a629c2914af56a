// Whole files in, whole files out.
#pragma once

#include <string>
#include <string_view>

namespace isochor {

// The content of a file. Throws InputError (missing, a directory, unreadable).
std::string read_file(const std::string& path);

// Writes through a temporary file in the same directory and renames it: afterwards `path` holds all
// of `content`, or what it held before. Throws InputError when the directory cannot be written.
void write_file(const std::string& path, std::string_view content);

// Throws InputError when no file can be made there (no such folder, not writable, a folder itself):
// for work that writes several files and should not stop after the first.
void require_writable(const std::string& path);

// A path beside `path` that does not exist yet, for writers that need a file name of their own.
// The extension is kept, because some writers choose the format by it.
std::string temporary_path_beside(const std::string& path);

// Moves a finished temporary file into place. Throws InputError; the temporary is removed then.
void move_into_place(const std::string& temporary, const std::string& path);

// The extension in lower case without the dot; "isochor.json" for model files.
std::string extension_of(const std::string& path);

}  // namespace isochor
