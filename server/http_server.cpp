#include "server/http_server.h"

#include <fcntl.h>
#include <sys/socket.h>

#include <algorithm>
#include <cstring>
#include <thread>

#define CPPHTTPLIB_LISTEN_BACKLOG 512
#define CPPHTTPLIB_REQUEST_URI_MAX_LENGTH 32000 // the features of a morph may be in it; lines end at 32768
#include <httplib.h>

#include "api/json.h"
#include "core/utf8.h"
#include "server/connections.h"
#include "server/file_descriptor.h"
#include "server/file_writer.h"
#include "server/http_text.h"
#include "server/log.h"
#include "server/web_files.h"

namespace orbis::server {
namespace {

using Clock = std::chrono::steady_clock;

// The connection that this thread serves.
thread_local Connections::Handle current_connection;
// Whether its last answer was an error: such answers say that the connection is closed.
thread_local bool answered_with_error = false;

api::Request plain_request(const httplib::Request& request) {
  api::Request plain;
  plain.method = request.method;
  plain.path = request.path;
  plain.query.assign(request.params.begin(), request.params.end());
  plain.headers.assign(request.headers.begin(), request.headers.end());
  return plain;
}

// Sends a file from disk in pieces.
void send_file(const api::FileBody& body, const std::string& type, httplib::Response& response) {
  auto file = std::make_shared<FileDescriptor>(::open(body.path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!file->is_open()) throw api::Refused(api::Refusal::expired, "the job expired just now; post the model again");
  const auto provide = [file, start = body.offset](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
    char buffer[64 << 10];
    const auto got = ::pread(file->get(), buffer, std::min(length, sizeof buffer), static_cast<off_t>(start + offset));
    return got > 0 && sink.write(buffer, static_cast<std::size_t>(got));
  };
  response.set_content_provider(body.length, type, provide);
}

void send_stream(api::StreamBody next, const std::string& type, httplib::Response& response) {
  response.set_chunked_content_provider(type, [next = std::move(next)](std::size_t, httplib::DataSink& sink) {
    const auto piece = next();
    if (piece) return sink.write(piece->data(), piece->size());
    sink.done();
    return true;
  });
}

// As the library found it, but for what it takes from a plain `filename`.
std::string file_name_of(const httplib::FormData& part) {
  const auto header = part.headers.find("Content-Disposition");
  if (header == part.headers.end() || header_parameter(header->second, "filename*")) return part.filename;
  return header_parameter(header->second, "filename").value_or(part.filename);
}

void fill(api::Response answer, httplib::Response& response) {
  const std::string type(answer.header("Content-Type"));
  if (auto* text = std::get_if<std::string>(&answer.body))
    response.body = std::move(*text);
  else if (const auto* file = std::get_if<api::FileBody>(&answer.body))
    send_file(*file, type, response);
  else
    send_stream(std::get<api::StreamBody>(std::move(answer.body)), type, response);
  response.status = answer.status;
  for (const auto& [name, value] : answer.headers) {
    if (!response.has_header(name)) response.set_header(name, value);
  }
}

void fill(const api::Problem& problem, httplib::Response& response) {
  response.status = problem.status;
  response.body = api::dump(api::to_json(problem));
  response.set_header("Content-Type", "application/problem+json");
}

// An upload on its way to the disk. Files that no job has taken over are removed with it.
class Upload {
public:
  explicit Upload(BlobStore& blobs) : blobs_(blobs) {}
  ~Upload() {
    std::error_code ignored; // a file that a job took over is not there any more
    for (const api::Part& part : parts) std::filesystem::remove(part.spooled, ignored);
  }
  Upload(const Upload&) = delete;
  Upload& operator=(const Upload&) = delete;

  // Files beyond these are no model's.
  static constexpr std::size_t max_parts = 256;

  [[nodiscard]] bool begin(std::string name, std::string file_name, std::string media_type) {
    end();
    if (parts.size() == max_parts) return false;
    const auto path = blobs_.spool_path();
    parts.push_back({std::move(name), std::move(file_name), std::move(media_type), path, 0, {}});
    writer_.emplace(path);
    return true;
  }
  void write(const char* bytes, std::size_t count) {
    writer_->write(std::as_bytes(std::span(bytes, count)));
    parts.back().bytes += count;
  }
  void end() {
    if (writer_) parts.back().sha256 = writer_->commit();
    writer_.reset();
  }

  std::vector<api::Part> parts;

private:
  BlobStore& blobs_;
  std::optional<FileWriter> writer_;
};

bool receive(Upload& upload, const httplib::Request& request, const httplib::ContentReader& read) {
  const auto write = [&](const char* bytes, std::size_t count) {
    upload.write(bytes, count);
    return true;
  };
  bool complete = false;
  if (request.is_multipart_form_data()) {
    complete = read(
        [&](const httplib::FormData& part) {
          return upload.begin(part.name, as_utf8(file_name_of(part)), part.content_type);
        },
        write);
  } else {
    complete = upload.begin("model", {}, {}) && read(write);
  }
  if (complete) upload.end();
  return complete;
}

const WebFile* web_file(const httplib::Request& request) {
  if (request.method != "GET" && request.method != "HEAD") return nullptr;
  const auto files = web_files();
  const auto it = std::ranges::find(files, std::string_view(request.path), &WebFile::path);
  return it == files.end() ? nullptr : &*it;
}

void send_web_file(const WebFile& file, httplib::Response& response) {
  response.status = 200;
  response.set_content(file.contents.data(), file.contents.size(), std::string(file.type));
  response.set_header("Cache-Control", "no-cache");
  response.set_header(
      "Content-Security-Policy",
      "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; connect-src 'self'");
}

bool is_probe(const std::string& path) { return path == "/livez" || path == "/readyz" || path == "/metrics"; }

// Runs connections on as many threads of the library as there are places, up to a number beyond which it grows when
// needed (a pool that grows counts threads that were woken and have not begun as idle, and lets connections wait for
// them), and makes room for those that wait.
class ConnectionQueue final : public httplib::TaskQueue {
public:
  ConnectionQueue(Connections& connections, std::size_t threads)
      : connections_(connections), pool_(std::min<std::size_t>(512, threads), threads),
        room_maker_([&connections](const std::stop_token& stop) { connections.make_room_until(stop); }) {}
  bool enqueue(std::function<void()> task) override {
    connections_.accepted();
    return pool_.enqueue(std::move(task));
  }
  void shutdown() override { pool_.shutdown(); }

private:
  Connections& connections_;
  httplib::ThreadPool pool_;
  std::jthread room_maker_;
};

} // namespace

class HttpServer::Impl final : public httplib::Server {
public:
  Impl(api::Router& router, BlobStore& blobs, Metrics& metrics, HttpSettings settings)
      : router_(router), blobs_(blobs), metrics_(metrics), settings_(std::move(settings)),
        connections_(settings_.connections) {
    configure();
    set_pre_routing_handler([this](const auto& request, auto& response) { return answer_head(request, response); });
    set_expect_100_continue_handler([this](const auto& request, auto& response) {
      return refuse_early(request, response) ? response.status : 100;
    });
    for (const char* path : {"/v1/jobs", "/v1/morphs"}) {
      Post(path, [this](const auto& request, auto& response, const auto& reader) {
        answer_upload(request, response, reader);
      });
    }
    set_error_handler([this](const auto&, auto& response) {
      explain(response);
      return HandlerResponse::Handled;
    });
    set_exception_handler(
        [](const auto&, auto& response, const std::exception_ptr& exception) { explain(exception, response); });
    set_post_routing_handler([](const auto&, auto& response) {
      response.set_header("Date", http_date(std::chrono::system_clock::now()));
      if (response.status == 204 || response.status == 304) response.headers.erase("Content-Length");
    });
    set_logger([this](const auto& request, const auto& response) { record(request, response); });
  }

private:
  void configure() {
    new_task_queue = [this] { return new ConnectionQueue(connections_, settings_.connections); };
    // Not SO_REUSEPORT, the library's default: a second server on the port must fail, not share it.
    set_socket_options([](socket_t socket) {
      const int yes = 1;
      ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    set_tcp_nodelay(true);
    set_read_timeout(settings_.read_timeout.count());
    set_write_timeout(settings_.write_timeout.count());
    set_keep_alive_timeout(settings_.keep_alive_timeout.count());
    constexpr std::uint64_t multipart_overhead = 1 << 20;
    set_payload_max_length(settings_.max_bytes + multipart_overhead);
  }

  // As the library's own, but the connection is entered in our list, and Range headers are left to the router.
  bool process_and_close_socket(socket_t socket) override {
    current_connection = connections_.open(socket);
    std::string remote_address, local_address;
    int remote_port = 0, local_port = 0;
    const bool result = httplib::detail::process_server_socket(
        svr_sock_, socket, keep_alive_max_count_, keep_alive_timeout_sec_, read_timeout_sec_, read_timeout_usec_,
        write_timeout_sec_, write_timeout_usec_, [&](httplib::Stream& stream, bool close, bool& closed) {
          answered_with_error = false;
          const bool goes_on =
              process_request(stream, remote_address, remote_port, local_address, local_port, close, closed, prepare);
          closed = closed || answered_with_error; // as the library tells the client
          return goes_on;
        });
    connections_.close(current_connection);
    ::shutdown(socket, SHUT_RDWR);
    ::close(socket);
    return result;
  }

  static void prepare(httplib::Request& request) {
    request.ranges.clear();
    // RFC 9112, section 6.3: without a length and a transfer coding a request has no body. The library would look for
    // that of a DELETE all the same, and take the connection's next request for it.
    if (!request.has_header("Content-Length") && !request.has_header("Transfer-Encoding"))
      request.body_consumed_ = true;
  }

  // The routes may wait; meanwhile the connection is not a slow one.
  api::Response handle(const api::Request& request) {
    connections_.set_working(current_connection, true);
    api::Response answer = router_.handle(request);
    connections_.set_working(current_connection, false);
    return answer;
  }

  bool refuse_early(const httplib::Request& request, httplib::Response& response) {
    if (!api::is_upload(request.method, request.path)) return false;
    if (auto refusal = router_.refuse_early(plain_request(request))) {
      fill(*std::move(refusal), response);
      return true;
    }
    return refuse_large(request.get_header_value_u64("Content-Length"), response);
  }

  bool refuse_large(std::uint64_t bytes, httplib::Response& response) const {
    if (bytes <= settings_.max_bytes) return false;
    fill(
        api::make_problem(Error(ErrorCode::too_large, "the body is larger than " + std::to_string(settings_.max_bytes) +
                                                          " bytes, the limit max_bytes of this service")),
        response);
    return true;
  }

  HandlerResponse answer_head(const httplib::Request& request, httplib::Response& response) {
    if (refuse_early(request, response)) return HandlerResponse::Handled;
    if (api::is_upload(request.method, request.path)) return HandlerResponse::Unhandled; // the body comes first
    if (const WebFile* file = web_file(request))
      send_web_file(*file, response);
    else
      fill(handle(plain_request(request)), response);
    return HandlerResponse::Handled;
  }

  void answer_upload(const httplib::Request& request, httplib::Response& response,
                     const httplib::ContentReader& reader) {
    Upload upload(blobs_);
    if (!receive(upload, request, reader)) {
      if (response.status < 400) response.status = 400; // explain() says more
      return;
    }
    // A body in chunks does not say beforehand how long it is.
    std::uint64_t bytes = 0;
    for (const api::Part& part : upload.parts) bytes += part.bytes;
    if (refuse_large(bytes, response)) return;
    api::Request plain = plain_request(request);
    plain.parts = upload.parts;
    fill(handle(plain), response);
  }

  // Gives errors of the library itself their problem document.
  void explain(httplib::Response& response) const {
    if (!response.body.empty()) return;
    response.headers.erase("Content-Length");
    switch (response.status) {
    case 413:
      (void)refuse_large(settings_.max_bytes + 1, response);
      return;
    case 414:
      return fill(api::make_problem(api::Refusal::uri_too_long,
                                    "the address is longer than " + std::to_string(CPPHTTPLIB_REQUEST_URI_MAX_LENGTH) +
                                        " bytes; options may be a part of the body, 'options', as JSON"),
                  response);
    case 415:
      return fill(api::make_problem(api::Refusal::unsupported_media_type, "compressed bodies are not accepted"),
                  response);
    case 416:
      return fill(api::make_problem(api::Refusal::range_not_satisfiable, "the Range header cannot be read"), response);
    case 500:
      return fill(api::make_problem(Error(ErrorCode::internal, "the request failed; the log says why")), response);
    default:
      return fill(api::make_problem(api::Refusal::bad_request,
                                    "the request is not HTTP as it should be, a header is longer than 8192 bytes, or "
                                    "its body is cut off or no valid multipart/form-data of at most " +
                                        std::to_string(Upload::max_parts) + " parts"),
                  response);
    }
  }

  static void explain(const std::exception_ptr& exception, httplib::Response& response) {
    try {
      std::rethrow_exception(exception);
    } catch (const api::Refused& refused) {
      fill(refused.problem(), response);
    } catch (const Error& error) {
      fill(api::make_problem(error), response);
    } catch (const std::exception& error) {
      log_event(Level::error, "request_failed", {{"reason", error.what()}});
      fill(api::make_problem(Error(ErrorCode::internal, "the request failed; the log says why")), response);
    }
  }

  void record(const httplib::Request& request, const httplib::Response& response) {
    const auto start = request.start_time_;
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    answered_with_error = response.status >= 400;
    metrics_.request(request.method, response.status, seconds);
    if (is_probe(request.path)) return;
    log_event(Level::info, "request",
              {{"method", request.method},
               {"path", request.path.substr(0, 200)},
               {"status", response.status},
               {"ms", seconds * 1e3}});
  }

  api::Router& router_;
  BlobStore& blobs_;
  Metrics& metrics_;
  HttpSettings settings_;
  Connections connections_;
  friend class HttpServer;
};

HttpServer::HttpServer(api::Router& router, BlobStore& blobs, Metrics& metrics, HttpSettings settings)
    : impl_(std::make_unique<Impl>(router, blobs, metrics, std::move(settings))) {}

HttpServer::~HttpServer() = default;

int HttpServer::bind() {
  const HttpSettings& settings = impl_->settings_;
  const int port = settings.port == 0                                  ? impl_->bind_to_any_port(settings.host)
                   : impl_->bind_to_port(settings.host, settings.port) ? settings.port
                                                                       : -1;
  if (port < 0) {
    throw Error(ErrorCode::invalid_option,
                "cannot listen on " + settings.host + " port " + std::to_string(settings.port) +
                    ": the address is taken, or not of this machine",
                "port");
  }
  return port;
}

void HttpServer::serve() {
  serving_ = true;
  const bool regular = stopping_ || impl_->listen_after_bind();
  serving_ = false;
  if (!regular) throw Error(ErrorCode::internal, "the server's socket failed");
}

void HttpServer::stop() {
  stopping_ = true;
  // The library forgets a stop that comes before it listens.
  while (serving_ && !impl_->is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  impl_->stop();
}

} // namespace orbis::server
