#include "server/worker_process.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/eventfd.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>

#include "server/file_descriptor.h"
#include "server/file_writer.h"
#include "server/job_messages.h"
#include "server/log.h"

namespace orbis::server {
namespace {

using Clock = std::chrono::steady_clock;

struct Pipe {
  FileDescriptor read_end, write_end;
  Pipe() {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) throw Error(ErrorCode::internal, "no more pipes can be opened");
    read_end = FileDescriptor(ends[0]);
    write_end = FileDescriptor(ends[1]);
  }
};

struct Death {
  int status = 0;
  rusage usage{};
};

// The child, with our ends of its standard input and output. Whatever happens, it does not outlive this object.
class Child {
public:
  Child(pid_t process, FileDescriptor to_child, FileDescriptor from_child)
      : pid(process), input(std::move(to_child)), output(std::move(from_child)) {}
  ~Child() {
    if (pid > 0) (void)reap();
  }
  Child(Child&& other) noexcept
      : pid(std::exchange(other.pid, -1)), input(std::move(other.input)), output(std::move(other.output)) {}
  Child& operator=(Child&&) = delete;
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  // Kills what still runs (no effect on a child that has ended) and takes its exit status.
  Death reap() {
    Death death;
    ::kill(pid, SIGKILL);
    while (::wait4(pid, &death.status, 0, &death.usage) < 0 && errno == EINTR) {
    }
    pid = -1;
    return death;
  }

  pid_t pid;
  FileDescriptor input, output;
};

Child spawn(const std::vector<std::string>& command) {
  Pipe input, output;
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, input.read_end.get(), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&files, output.write_end.get(), STDOUT_FILENO);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  // Its own process group: a Ctrl-C at the terminal is for the parent, which then stops its children.
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  sigset_t none, defaults;
  sigemptyset(&none);
  sigemptyset(&defaults);
  sigaddset(&defaults, SIGPIPE);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &defaults);

  std::vector<char*> arguments;
  arguments.reserve(command.size() + 1);
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  pid_t pid = -1;
  const int error = ::posix_spawn(&pid, command.front().c_str(), &files, &attributes, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&attributes);
  if (error != 0) {
    log_event(Level::error, "spawn", {{"reason", std::strerror(error)}});
    throw Error(ErrorCode::internal, "the job's process could not be started");
  }
  ::fcntl(input.write_end.get(), F_SETFL, O_NONBLOCK);
  return {pid, std::move(input.write_end), std::move(output.read_end)};
}

// The task and the bytes of its files, in pieces.
class InputStream {
public:
  explicit InputStream(const JobTask& task) : pending_(task_line(task)) {
    files_.push_back(task.model);
    files_.insert(files_.end(), task.files.begin(), task.files.end());
    if (task.checkpoint) files_.push_back(*task.checkpoint);
  }

  // What is to be written next; empty at the end.
  [[nodiscard]] std::string_view pending() {
    while (offset_ == pending_.size() && next_ < files_.size()) refill();
    return std::string_view(pending_).substr(offset_);
  }
  void written(std::size_t bytes) { offset_ += bytes; }

private:
  void refill() {
    constexpr std::uint64_t piece = 256 << 10;
    const InputFile& file = files_[next_];
    if (!open_.is_open()) {
      open_ = FileDescriptor(::open(file.path.c_str(), O_RDONLY | O_CLOEXEC));
      left_ = file.bytes;
      if (!open_.is_open()) throw Error(ErrorCode::internal, "an input file of the job is gone");
    }
    pending_.resize(static_cast<std::size_t>(std::min(piece, left_)));
    offset_ = 0;
    const auto got = pending_.empty() ? 0 : ::read(open_.get(), pending_.data(), pending_.size());
    if (got < 0 || (got == 0 && left_ > 0)) throw Error(ErrorCode::internal, "an input file of the job is cut off");
    pending_.resize(static_cast<std::size_t>(got));
    left_ -= static_cast<std::uint64_t>(got);
    if (left_ == 0) {
      open_.reset();
      ++next_;
    }
  }

  std::string pending_;
  std::size_t offset_ = 0, next_ = 0;
  std::vector<InputFile> files_;
  FileDescriptor open_;
  std::uint64_t left_ = 0;
};

// Puts the child's files where they belong.
class OutputFiles {
public:
  OutputFiles(const JobHooks& hooks, std::uint64_t limit) : hooks_(hooks), left_(limit) {}

  void begin(std::string_view name, std::uint64_t bytes) {
    if (bytes > left_) throw Error(ErrorCode::too_large, "the job's results are larger than a job's may be here");
    if (name != checkpoint_name) left_ -= bytes; // the next one takes its place
    name_ = name;
    if (const auto path = hooks_.place(name); !path.empty()) writer_.emplace(path);
  }
  void write(std::span<const std::byte> bytes) {
    if (writer_) writer_->write(bytes);
  }
  void end() {
    if (!writer_) return;
    const std::uint64_t bytes = writer_->bytes();
    std::erase_if(done_, [&](const OutputFile& earlier) { return earlier.name == name_; });
    done_.push_back({name_, bytes, writer_->commit()});
    writer_.reset();
  }
  [[nodiscard]] std::vector<OutputFile> take() { return std::move(done_); }

private:
  const JobHooks& hooks_;
  std::uint64_t left_;
  std::string name_;
  std::optional<FileWriter> writer_;
  std::vector<OutputFile> done_;
};

// One talk with one child, from the task to its last word.
class Conversation {
public:
  Conversation(const JobTask& task, const JobHooks& hooks, const Child& child, int stop_event)
      : input_(task), files_(hooks, task.limits.output_bytes), child_(child), stop_event_(stop_event),
        end_(Clock::now() + std::chrono::seconds(task.limits.seconds)), seconds_(task.limits.seconds),
        parser_({hooks.progress, [this](auto name, auto bytes) { files_.begin(name, bytes); },
                 [this](auto bytes) { files_.write(bytes); }, [this] { files_.end(); },
                 [this](const Error& error) { last_word_ = error; },
                 [](auto text) {
                   log_event(Level::error, "job_process", {{"reason", text}});
                 },
                 [this] { done_ = true; }}) {}

  // Until the child closes its output. Sets why it was stopped, if it was.
  void hold() {
    while (step()) {
    }
  }

  [[nodiscard]] const std::optional<Error>& stopped() const { return stopped_; }
  [[nodiscard]] const std::optional<Error>& last_word() const { return last_word_; }
  [[nodiscard]] bool done() const { return done_; }
  [[nodiscard]] std::vector<OutputFile> take_files() { return files_.take(); }

private:
  bool step() {
    if (!input_done_ && input_.pending().empty()) input_done_ = true;
    pollfd fds[3] = {{child_.output.get(), POLLIN, 0},
                     {stopped_ ? -1 : stop_event_, POLLIN, 0},
                     {input_done_ ? -1 : child_.input.get(), POLLOUT, 0}};
    const auto wait = std::chrono::ceil<std::chrono::milliseconds>(end_ - Clock::now());
    const int ready = ::poll(fds, 3, static_cast<int>(std::clamp<std::int64_t>(wait.count(), 0, 60'000)));
    if (ready < 0 && errno != EINTR) throw Error(ErrorCode::internal, "the job's process cannot be watched");
    if (ready > 0 && fds[1].revents != 0) stop(Error(ErrorCode::canceled, "the job was canceled"));
    if (Clock::now() >= end_) time_is_over();
    if (ready > 0 && fds[2].revents != 0) write_input();
    return ready <= 0 || fds[0].revents == 0 || read_output();
  }

  // The child has nothing to put in order: it writes no files, and its checkpoints are here already.
  void stop(Error why) {
    stopped_ = std::move(why);
    ::kill(child_.pid, SIGKILL);
    end_ = Clock::time_point::max();
  }

  void time_is_over() {
    stop(Error(ErrorCode::out_of_time,
               "the job was stopped after " + std::to_string(seconds_) + " seconds, the limit of this service"));
  }

  void write_input() {
    const std::string_view pending = input_.pending();
    const auto written = ::write(child_.input.get(), pending.data(), pending.size());
    if (written > 0) {
      input_.written(static_cast<std::size_t>(written));
    } else if (errno != EAGAIN && errno != EINTR) {
      input_done_ = true; // the child reads no more: its output says why
    }
  }

  bool read_output() {
    std::byte buffer[64 << 10];
    const auto got = ::read(child_.output.get(), buffer, sizeof buffer);
    if (got < 0) return errno == EINTR;
    if (got > 0) parser_.feed(std::span(buffer, static_cast<std::size_t>(got)));
    return got > 0;
  }

  InputStream input_;
  OutputFiles files_;
  const Child& child_;
  int stop_event_;
  Clock::time_point end_;
  std::uint32_t seconds_;
  bool input_done_ = false, done_ = false;
  std::optional<Error> stopped_, last_word_;
  MessageParser parser_;
};

double milliseconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_usec) * 1e-3;
}

// What a child's end means where it had no last word.
Error cause_of_death(int status) {
  const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  log_event(Level::error, "job_process_died", {{"signal", signal}, {"status", status}});
  switch (signal) {
  case SIGXCPU:
    return {ErrorCode::out_of_time, "the job used up the processor time that a job may use here"};
  case SIGKILL:
    return {ErrorCode::out_of_memory, "the system stopped the job, most likely for want of memory"};
  default:
    return {ErrorCode::internal, "the job's process ended unexpectedly; this model breaks something in orbis"};
  }
}

} // namespace

JobOutcome WorkerProcess::run(const JobTask& task, const JobHooks& hooks, std::stop_token stop) {
  const auto start = Clock::now();
  const FileDescriptor stop_event(::eventfd(0, EFD_CLOEXEC));
  const std::stop_callback wake(stop, [&] { ::eventfd_write(stop_event.get(), 1); });
  Child child = spawn(command_);

  JobOutcome outcome;
  std::optional<Error> broken;
  Conversation conversation(task, hooks, child, stop_event.get());
  try {
    conversation.hold();
  } catch (const Error& error) {
    broken = error;
  }
  const auto [status, usage] = child.reap();

  outcome.wall_ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  outcome.cpu_ms = milliseconds(usage.ru_utime) + milliseconds(usage.ru_stime);
  outcome.peak_rss_bytes = static_cast<std::uint64_t>(usage.ru_maxrss) << 10;
  outcome.files = conversation.take_files();
  if (conversation.done()) return outcome;
  outcome.error = broken;
  if (!outcome.error) outcome.error = conversation.stopped();
  if (!outcome.error) outcome.error = conversation.last_word();
  if (!outcome.error) outcome.error = cause_of_death(status);
  return outcome;
}

} // namespace orbis::server
