#include "server/file_writer.h"

#include <fcntl.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstring>

#include "core/error.h"
#include "server/log.h"

namespace orbis::server {
namespace {

[[noreturn]] void fail(std::string_view what, const std::filesystem::path& path) {
  const int reason = errno;
  log_event(Level::error, "file", {{"what", what}, {"path", path.string()}, {"reason", std::strerror(reason)}});
  throw Error(ErrorCode::internal, reason == ENOSPC
                                       ? std::string("the disk is full")
                                       : "the file '" + path.filename().string() + "' could not be written");
}

// Makes the rename itself durable.
void sync_directory(const std::filesystem::path& directory) {
  const FileDescriptor fd(::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!fd.is_open() || ::fsync(fd.get()) != 0) fail("sync", directory);
}

} // namespace

FileWriter::FileWriter(std::filesystem::path path) : path_(std::move(path)) {
  std::string name = (path_.parent_path() / (".new-XXXXXX")).string();
  file_ = FileDescriptor(::mkostemp(name.data(), O_CLOEXEC));
  if (!file_.is_open()) fail("create", path_);
  temporary_ = name;
}

FileWriter::~FileWriter() {
  if (file_.is_open()) ::unlink(temporary_.c_str());
}

void FileWriter::write(std::span<const std::byte> bytes) {
  hash_.update(bytes);
  bytes_ += bytes.size();
  while (!bytes.empty()) {
    const auto written = ::write(file_.get(), bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("write", path_);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

std::string FileWriter::commit() {
  if (::fchmod(file_.get(), 0644) != 0 || ::fsync(file_.get()) != 0) fail("sync", path_);
  if (::rename(temporary_.c_str(), path_.c_str()) != 0) fail("rename", path_);
  file_.reset();
  sync_directory(path_.parent_path().empty() ? "." : path_.parent_path());
  return hash_.finish();
}

std::vector<std::byte> read_file(const std::filesystem::path& path, std::uint64_t limit) {
  const FileDescriptor fd(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  struct stat info {};
  if (!fd.is_open() || ::fstat(fd.get(), &info) != 0 || !S_ISREG(info.st_mode)) {
    throw Error(ErrorCode::missing_resource, "the file '" + path.filename().string() + "' cannot be read");
  }
  const auto size = static_cast<std::uint64_t>(info.st_size);
  if (size > limit) {
    throw Error(ErrorCode::too_large, "the file '" + path.filename().string() + "' has " + std::to_string(size) +
                                          " bytes; the limit max_bytes is " + std::to_string(limit));
  }
  std::vector<std::byte> bytes(size);
  std::size_t done = 0;
  while (done < bytes.size()) {
    const auto got = ::read(fd.get(), bytes.data() + done, bytes.size() - done);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0)
      throw Error(ErrorCode::missing_resource, "the file '" + path.filename().string() + "' cannot be read");
    done += static_cast<std::size_t>(got);
  }
  return bytes;
}

} // namespace orbis::server
