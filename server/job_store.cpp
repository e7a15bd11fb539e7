#include "server/job_store.h"

#include "api/json.h"
#include "core/error.h"
#include "server/job_files.h"

namespace orbis::server {
namespace {

using api::Json;

constexpr std::int64_t schema_version = 2;

// What is searched has a column; the rest is one JSON document.
constexpr const char* schema = R"sql(
  BEGIN;
  CREATE TABLE jobs (
    id TEXT PRIMARY KEY,
    state TEXT NOT NULL,
    expires INTEGER,
    idempotency_key TEXT UNIQUE,
    document TEXT NOT NULL
  ) WITHOUT ROWID;
  CREATE INDEX jobs_by_state ON jobs (state, id);
  CREATE INDEX jobs_by_expiry ON jobs (expires);
  PRAGMA user_version = 1;
  COMMIT;
)sql";

// Jobs of before have no key and answer nobody.
constexpr const char* second_schema = R"sql(
  BEGIN;
  ALTER TABLE jobs ADD COLUMN cache_key TEXT;
  CREATE INDEX jobs_by_cache_key ON jobs (cache_key, id) WHERE state = 'succeeded';
  PRAGMA user_version = 2;
  COMMIT;
)sql";

// Creates the tables of a new database, and brings an old one up to date, before the statements on them are prepared.
Database open_database(const std::filesystem::path& file) {
  Database database(file);
  Statement query = database.prepare("PRAGMA user_version");
  query.step();
  const std::int64_t version = query.number(0);
  query.reset();
  if (version < 1) database.execute(schema);
  if (version < 2) database.execute(second_schema);
  if (version > schema_version) {
    throw Error(ErrorCode::internal, "the job database was written by a newer version of orbis");
  }
  return database;
}

Json time_json(const std::optional<api::Time>& time) {
  return time ? Json(time->time_since_epoch().count()) : Json(nullptr);
}

std::optional<api::Time> time_from(const Json& json) {
  if (json.is_null()) return std::nullopt;
  return api::Time(std::chrono::milliseconds(json.get<std::int64_t>()));
}

Json document_of(const StoredJob& stored) {
  const api::Job& job = stored.job;
  Json inputs = Json::array(), outputs = Json::object();
  for (const StoredInput& input : stored.inputs) inputs.push_back({{"name", input.name}, {"bytes", input.bytes}});
  for (const auto& [name, file] : stored.outputs) outputs[name] = {{"sha256", file.sha256}, {"bytes", file.bytes}};
  return {{"created", time_json(job.created)},
          {"started", time_json(job.started)},
          {"finished", time_json(job.finished)},
          {"expires", time_json(job.expires)},
          {"attempt", job.attempt},
          {"cached", job.cached},
          {"version", job.version},
          {"options", api::to_json(job.options)},
          {"progress", job.progress ? api::to_json(*job.progress) : Json(nullptr)},
          {"timing", api::to_json(job.timing)},
          {"sha256", job.input.sha256},
          {"bytes", job.input.bytes},
          {"partial", job.partial},
          {"triangles", job.input.triangles ? Json(*job.input.triangles) : Json(nullptr)},
          {"problem", job.problem ? api::to_json(*job.problem) : Json(nullptr)},
          {"fingerprint", stored.fingerprint},
          {"inputs", std::move(inputs)},
          {"outputs", std::move(outputs)}};
}

StoredJob stored_job(const Json& json) {
  StoredJob stored;
  api::Job& job = stored.job;
  job.created = time_from(json.at("created")).value();
  job.started = time_from(json.at("started"));
  job.finished = time_from(json.at("finished"));
  job.expires = time_from(json.at("expires"));
  json.at("attempt").get_to(job.attempt);
  job.cached = json.value("cached", false); // the first schema had none
  json.at("version").get_to(job.version);
  job.options = api::options_from_json(json.at("options"));
  if (!json.at("progress").is_null()) job.progress = api::progress_from_json(json.at("progress"));
  job.timing = api::timing_from_json(json.at("timing"));
  json.at("sha256").get_to(job.input.sha256);
  json.at("bytes").get_to(job.input.bytes);
  if (!json.at("triangles").is_null()) job.input.triangles = json.at("triangles").get<std::uint64_t>();
  job.partial = json.value("partial", false); // of a later version than the first stores
  if (!json.at("problem").is_null()) job.problem = api::problem_from_json(json.at("problem"));
  json.at("fingerprint").get_to(stored.fingerprint);
  for (const Json& input : json.at("inputs")) {
    stored.inputs.push_back({input.at("name").get<std::string>(), input.at("bytes").get<std::uint64_t>()});
  }
  for (const auto& [name, file] : json.at("outputs").items()) {
    stored.outputs.emplace_back(
        name, api::JobResult{file.at("sha256").get<std::string>(), file.at("bytes").get<std::uint64_t>()});
    if (name == "result.glb") job.result = stored.outputs.back().second;
    if (auto map = map_of_output(name)) job.maps.push_back(*std::move(map));
  }
  return stored;
}

StoredJob read_row(const Statement& row) {
  try {
    StoredJob stored = stored_job(Json::parse(row.text(3)));
    stored.job.id = row.text(0);
    stored.job.state = api::job_state(row.text(1)).value();
    stored.idempotency_key = row.text(2);
    return stored;
  } catch (const std::exception&) {
    throw Error(ErrorCode::internal, "the job database holds a damaged job");
  }
}

#define ORBIS_COLUMNS "SELECT id, state, idempotency_key, document FROM jobs "

} // namespace

JobStore::JobStore(const std::filesystem::path& file)
    : database_(open_database(file)),
      insert_(database_.prepare(
          "INSERT INTO jobs (state, expires, document, id, idempotency_key, cache_key) VALUES (?, ?, ?, ?, ?, ?)")),
      update_(database_.prepare("UPDATE jobs SET state = ?, expires = ?, document = ? WHERE id = ?")),
      find_(database_.prepare(ORBIS_COLUMNS "WHERE id = ?")),
      release_key_(database_.prepare("UPDATE jobs SET idempotency_key = NULL WHERE id = ?")),
      find_by_key_(database_.prepare(ORBIS_COLUMNS "WHERE idempotency_key = ?")),
      find_result_(
          database_.prepare(ORBIS_COLUMNS "WHERE cache_key = ? AND state = 'succeeded' ORDER BY id DESC LIMIT 1")),
      list_(database_.prepare(ORBIS_COLUMNS "WHERE (?1 = '' OR id < ?1) AND (?2 = '' OR state = ?2) "
                                            "ORDER BY id DESC LIMIT ?3")),
      unfinished_(database_.prepare(ORBIS_COLUMNS "WHERE state IN ('queued', 'running') ORDER BY id")),
      due_(database_.prepare(ORBIS_COLUMNS "WHERE expires <= ? AND state <> 'expired' ORDER BY expires LIMIT 100")),
      forget_(database_.prepare("DELETE FROM jobs WHERE state = 'expired' AND expires < ?")) {}

#undef ORBIS_COLUMNS

namespace {

std::vector<StoredJob> rows(Statement& query) {
  std::vector<StoredJob> jobs;
  try {
    while (query.step()) jobs.push_back(read_row(query));
  } catch (const Error&) {
    query.reset();
    throw;
  }
  return jobs;
}

void bind_changes(Statement& statement, const StoredJob& stored) {
  statement.bind(0, api::name_of(stored.job.state));
  if (stored.job.expires)
    statement.bind(1, stored.job.expires->time_since_epoch().count());
  else
    statement.bind_null(1);
  statement.bind(2, api::dump(document_of(stored))).bind(3, stored.job.id);
}

void bind_key(Statement& statement, int index, const std::string& key) {
  if (key.empty())
    statement.bind_null(index);
  else
    statement.bind(index, key);
}

} // namespace

void JobStore::insert(const StoredJob& stored) {
  bind_changes(insert_, stored);
  bind_key(insert_, 4, stored.idempotency_key);
  bind_key(insert_, 5, stored.cache_key);
  insert_.run();
}

void JobStore::update(const StoredJob& stored) {
  bind_changes(update_, stored);
  update_.run();
}

std::optional<StoredJob> JobStore::find(std::string_view id) {
  auto jobs = rows(find_.bind(0, id));
  return jobs.empty() ? std::nullopt : std::optional(std::move(jobs.front()));
}

std::optional<StoredJob> JobStore::find_by_key(std::string_view idempotency_key) {
  auto jobs = rows(find_by_key_.bind(0, idempotency_key));
  return jobs.empty() ? std::nullopt : std::optional(std::move(jobs.front()));
}

std::optional<StoredJob> JobStore::find_result(std::string_view cache_key) {
  auto jobs = rows(find_result_.bind(0, cache_key));
  return jobs.empty() ? std::nullopt : std::optional(std::move(jobs.front()));
}

std::vector<StoredJob> JobStore::list(const api::JobQuery& query) {
  const std::string_view state = query.state ? api::name_of(*query.state) : std::string_view("");
  return rows(list_.bind(0, query.cursor).bind(1, state).bind(2, static_cast<std::int64_t>(query.limit)));
}

std::vector<StoredJob> JobStore::unfinished() { return rows(unfinished_); }

std::vector<StoredJob> JobStore::due(api::Time time) { return rows(due_.bind(0, time.time_since_epoch().count())); }

void JobStore::release_key(std::string_view id) { release_key_.bind(0, id).run(); }

void JobStore::forget_expired(api::Time time) { forget_.bind(0, time.time_since_epoch().count()).run(); }

} // namespace orbis::server
