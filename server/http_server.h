// The HTTP/1.1 front: sockets, uploads to disk, downloads from disk. The only home of cpp-httplib.
//
// Each connection has a thread, of which there is a bounded number. Where all are taken and others wait, the
// connections that have been longest without work for us (idle, or slow to send or to read) are closed, so that slow
// clients cannot keep probes and others out.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "api/router.h"
#include "server/blob_store.h"
#include "server/metrics.h"

namespace orbis::server {

struct HttpSettings {
  std::string host = "127.0.0.1";
  int port = 8080;                        // 0: any free port
  std::uint32_t connections = 256;        // at a time
  std::uint64_t max_bytes = 256ull << 20; // of a request's body
  std::chrono::seconds read_timeout{10};  // without a byte from the client
  std::chrono::seconds write_timeout{10}; // without a byte taken by the client
  std::chrono::seconds keep_alive_timeout{5};
};

class HttpServer {
public:
  HttpServer(api::Router& router, BlobStore& blobs, Metrics& metrics, HttpSettings settings);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  // Binds; returns the port. Throws Error{internal} where the address is taken or unknown.
  [[nodiscard]] int bind();
  // Serves until stop(). Call after bind().
  void serve();
  // Thread-safe. Requests that are being answered are finished.
  void stop();

private:
  class Impl;
  std::unique_ptr<Impl> impl_;
  std::atomic<bool> serving_{false}, stopping_{false};
};

} // namespace orbis::server
