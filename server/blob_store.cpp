#include "server/blob_store.h"

#include "core/error.h"
#include "server/log.h"

namespace orbis::server {
namespace fs = std::filesystem;

namespace {

// File system errors carry paths: they go to the log, not to the client.
template <class Action> auto guarded(std::string_view what, Action action) {
  try {
    return action();
  } catch (const fs::filesystem_error& error) {
    log_event(Level::error, "blob_store", {{"what", what}, {"reason", error.what()}});
    throw Error(ErrorCode::internal, "the data directory refuses to " + std::string(what));
  }
}

} // namespace

BlobStore::BlobStore(const fs::path& data) : jobs_(data / "jobs"), spool_(data / "spool") {
  guarded("be set up", [&] {
    fs::remove_all(spool_);
    fs::create_directories(spool_);
    fs::create_directories(jobs_);
  });
}

fs::path BlobStore::spool_path() { return spool_ / std::to_string(next_upload_++); }

void BlobStore::adopt(std::string_view job, std::size_t number, const api::Part& part) {
  guarded("take an upload", [&] {
    fs::create_directories(directory(job));
    fs::rename(part.spooled, input_path(job, number));
  });
}

void BlobStore::share(std::string_view from, std::string_view to, const std::vector<std::string>& outputs) {
  guarded("share a result", [&] {
    fs::create_directories(directory(to));
    for (const std::string& name : outputs) fs::create_hard_link(output_path(from, name), output_path(to, name));
  });
}

fs::path BlobStore::input_path(std::string_view job, std::size_t number) const {
  return directory(job) / ("input-" + std::to_string(number));
}

fs::path BlobStore::output_path(std::string_view job, std::string_view name) const { return directory(job) / name; }

void BlobStore::remove(std::string_view job) {
  guarded("delete a job's files", [&] { fs::remove_all(directory(job)); });
}

void BlobStore::remove_output(std::string_view job, std::string_view name) const {
  guarded("delete a job's files", [&] { fs::remove(output_path(job, name)); });
}

std::optional<std::uint64_t> BlobStore::output_size(std::string_view job, std::string_view name) const {
  std::error_code none;
  const auto bytes = fs::file_size(output_path(job, name), none);
  return none ? std::nullopt : std::optional<std::uint64_t>(bytes);
}

std::vector<std::string> BlobStore::jobs() const {
  return guarded("be listed", [&] {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(jobs_)) names.push_back(entry.path().filename().string());
    return names;
  });
}

} // namespace orbis::server
