// SQLite with owned handles. The only home of the SQLite library.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

namespace orbis::server {

// A prepared statement. Parameters and columns count from 0.
class Statement {
public:
  Statement(sqlite3* database, std::string_view sql);
  ~Statement();
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;
  Statement(Statement&& other) noexcept;
  Statement& operator=(Statement&&) = delete;

  Statement& bind(int index, std::string_view text);
  Statement& bind(int index, std::int64_t number);
  Statement& bind_null(int index);
  // The next row; false at the end, after which the statement can be bound and run again.
  bool step();
  // Runs a statement that gives no rows.
  void run();
  // Ends a query early.
  void reset();

  [[nodiscard]] bool is_null(int column) const;
  [[nodiscard]] std::int64_t number(int column) const;
  [[nodiscard]] std::string text(int column) const;

private:
  sqlite3* database_;
  sqlite3_stmt* statement_ = nullptr;
};

// One connection. Not thread-safe: its owner has the lock. Throws Error{internal}; SQLite's own words go to the log.
class Database {
public:
  explicit Database(const std::filesystem::path& file);
  [[nodiscard]] Statement prepare(std::string_view sql) { return {database_.get(), sql}; }
  void execute(const std::string& sql);

private:
  struct Close {
    void operator()(sqlite3* database) const;
  };
  std::unique_ptr<sqlite3, Close> database_;
};

} // namespace orbis::server
