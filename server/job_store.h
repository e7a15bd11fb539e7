// The jobs, on disk: what must survive a restart. SQLite, one writer.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "api/job_service.h"
#include "server/sqlite.h"

namespace orbis::server {

struct StoredInput {
  std::string name; // as the model names it; "model" for the model itself, which is the first
  std::uint64_t bytes = 0;
};

// A job with what only the server needs to know.
struct StoredJob {
  api::Job job;
  std::vector<StoredInput> inputs;
  std::string idempotency_key; // "" for none
  std::string fingerprint;     // of the request's contents: SHA-256 of options and files
  std::string cache_key;       // of what decides the result's bytes: options, files and build; "" where nobody may ask
  std::vector<std::pair<std::string, api::JobResult>> outputs; // by name: size and digest of each file
};

// Not thread-safe: the scheduler has the lock.
class JobStore {
public:
  // Opens or creates the database; refuses one that a newer version of orbis has written.
  explicit JobStore(const std::filesystem::path& file);

  void insert(const StoredJob& stored);
  // Writes what changes after the insertion: state, times, attempt, timing, input, outputs, result, problem.
  void update(const StoredJob& stored);
  [[nodiscard]] std::optional<StoredJob> find(std::string_view id);
  [[nodiscard]] std::optional<StoredJob> find_by_key(std::string_view idempotency_key);
  // The newest job of that cache key that has succeeded and not expired.
  [[nodiscard]] std::optional<StoredJob> find_result(std::string_view cache_key);
  // Newest first, from after query.cursor on, at most query.limit.
  [[nodiscard]] std::vector<StoredJob> list(const api::JobQuery& query);
  // Oldest first.
  [[nodiscard]] std::vector<StoredJob> unfinished();
  // Finished jobs whose time is over at `time`, at most 100.
  [[nodiscard]] std::vector<StoredJob> due(api::Time time);
  // Another job may have its Idempotency-Key.
  void release_key(std::string_view id);
  // Forgets jobs that expired before `time`.
  void forget_expired(api::Time time);

private:
  Database database_;
  Statement insert_, update_, find_, release_key_, find_by_key_, find_result_, list_, unfinished_, due_, forget_;
};

} // namespace orbis::server
