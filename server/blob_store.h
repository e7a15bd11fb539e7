// Where uploads and results lie: one directory for each job under DATA/jobs, uploads under DATA/spool until then.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "api/http.h"

namespace orbis::server {

// Names in the store are its own: a client's file name is never a path.
class BlobStore {
public:
  // Creates the directories; empties the spool of an earlier run. Throws Error{internal} where it cannot.
  explicit BlobStore(const std::filesystem::path& data);

  // A fresh name for an upload.
  [[nodiscard]] std::filesystem::path spool_path();
  // Moves an uploaded part into a job's directory, as its number-th input file.
  void adopt(std::string_view job, std::size_t number, const api::Part& part);

  // Gives a job the named outputs of another: the same files under a second name, each with a life of its own.
  void share(std::string_view from, std::string_view to, const std::vector<std::string>& outputs);

  [[nodiscard]] std::filesystem::path input_path(std::string_view job, std::size_t number) const;
  [[nodiscard]] std::filesystem::path output_path(std::string_view job, std::string_view name) const;
  void remove(std::string_view job);
  void remove_output(std::string_view job, std::string_view name) const;
  // Its size in bytes; nothing where there is no such output.
  [[nodiscard]] std::optional<std::uint64_t> output_size(std::string_view job, std::string_view name) const;
  // Directories in the store, to find what no job owns.
  [[nodiscard]] std::vector<std::string> jobs() const;

private:
  [[nodiscard]] std::filesystem::path directory(std::string_view job) const { return jobs_ / job; }

  std::filesystem::path jobs_, spool_;
  std::atomic<std::uint64_t> next_upload_{0};
};

} // namespace orbis::server
