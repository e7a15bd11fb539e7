// Files that are there whole or not at all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "server/file_descriptor.h"
#include "server/sha256.h"

namespace orbis::server {

// Writes to a temporary file beside `path`; commit() makes it durable and gives it its name. Without commit() the
// temporary file is removed. Throws Error{internal} where the disk refuses; the reason goes to the log.
class FileWriter {
public:
  explicit FileWriter(std::filesystem::path path);
  ~FileWriter();
  FileWriter(FileWriter&&) noexcept = default;
  FileWriter& operator=(FileWriter&&) = delete;
  FileWriter(const FileWriter&) = delete;
  FileWriter& operator=(const FileWriter&) = delete;

  void write(std::span<const std::byte> bytes);
  // The SHA-256 of what was written.
  [[nodiscard]] std::string commit();
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

private:
  std::filesystem::path path_, temporary_;
  FileDescriptor file_;
  Sha256 hash_;
  std::uint64_t bytes_ = 0;
};

// The whole file, at most `limit` bytes; throws Error{too_large} beyond, Error{missing_resource} where it cannot be
// read.
[[nodiscard]] std::vector<std::byte> read_file(const std::filesystem::path& path, std::uint64_t limit);

} // namespace orbis::server
