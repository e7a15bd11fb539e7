// The HTTP front over real sockets, with jobs that a test runner runs.
#include <arpa/inet.h>
#include <doctest/doctest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <nlohmann/json.hpp>
#include <thread>

#include "server/fake_runner.h"
#include "server/http_server.h"
#include "server/scheduler.h"
#include "support/temporary_directory.h"

using namespace orbis;
using nlohmann::json;

namespace {

struct Answer {
  int status = 0;
  std::string head, body;
  [[nodiscard]] std::string header(const std::string& name) const {
    const auto at = head.find("\r\n" + name + ": ");
    if (at == std::string::npos) return "";
    const auto begin = at + name.size() + 4;
    return head.substr(begin, head.find("\r\n", begin) - begin);
  }
};

struct Site {
  test::TemporaryDirectory directory;
  test::FakeRunner runner;
  server::JobStore store{directory.path / "jobs.sqlite"};
  server::BlobStore blobs{directory.path};
  server::Metrics metrics;
  server::Scheduler scheduler{store, blobs, runner, metrics, {}};
  api::Router router{scheduler, {}};
  std::unique_ptr<server::HttpServer> http;
  int port = 0;
  std::jthread thread;

  Site() { scheduler.start(); }
  ~Site() {
    runner.release();
    if (http) http->stop();
  }
  void open(server::HttpSettings settings = {}) {
    settings.port = 0;
    http = std::make_unique<server::HttpServer>(router, blobs, metrics, settings);
    port = http->bind();
    thread = std::jthread([this] { http->serve(); });
  }

  [[nodiscard]] server::FileDescriptor connect() const {
    server::FileDescriptor socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    REQUIRE(::connect(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
    return socket;
  }
  static void send(const server::FileDescriptor& socket, std::string_view text) {
    while (!text.empty()) {
      const auto sent = ::send(socket.get(), text.data(), text.size(), MSG_NOSIGNAL);
      if (sent <= 0) return; // the server has closed: its answer says why
      text.remove_prefix(static_cast<std::size_t>(sent));
    }
  }
  // All until the server closes.
  static Answer receive(const server::FileDescriptor& socket) {
    std::string text(1 << 16, '\0'), all;
    for (ssize_t got = 0; (got = ::recv(socket.get(), text.data(), text.size(), 0)) > 0;) {
      all.append(text, 0, static_cast<std::size_t>(got));
    }
    Answer answer;
    const auto end = all.find("\r\n\r\n");
    if (end == std::string::npos) return answer;
    answer.head = all.substr(0, end + 2);
    answer.body = all.substr(end + 4);
    answer.status = std::stoi(answer.head.substr(9, 3));
    return answer;
  }
  [[nodiscard]] Answer ask(const std::string& method, const std::string& path, const std::string& headers = "",
                           const std::string& body = "") const {
    const auto socket = connect();
    std::string text = method + " " + path + " HTTP/1.1\r\nHost: test\r\nConnection: close\r\n" + headers;
    if (method == "POST") text += "Content-Length: " + std::to_string(body.size()) + "\r\n";
    send(socket, text + "\r\n" + body);
    return receive(socket);
  }
};

const std::string glb = "Content-Type: model/gltf-binary\r\n";

} // namespace

TEST_CASE_FIXTURE(Site, "one request does the whole job") {
  open();
  const Answer answer = ask("POST", "/v1/jobs", glb + "Prefer: wait=60\r\n", "glTF....");
  CHECK(answer.status == 200);
  CHECK(answer.body == "contents of result.glb");
  CHECK(answer.header("Content-Type") == "model/gltf-binary");
  CHECK(answer.header("Content-Length") == "22");
}

TEST_CASE_FIXTURE(Site, "a result is served whole, in part, and not at all to those who have it") {
  open();
  const std::string job = ask("POST", "/v1/jobs", glb + "Prefer: wait=60\r\n", "glTF....").header("Location");
  const Answer whole = ask("GET", job + "/result");
  CHECK(whole.body == "contents of result.glb");
  const Answer part = ask("GET", job + "/result", "Range: bytes=9-10\r\n");
  CHECK(part.status == 206);
  CHECK(part.body == "of");
  CHECK(part.header("Content-Range") == "bytes 9-10/22");
  CHECK(ask("GET", job + "/result", "Range: bytes=99-\r\n").status == 416);
  const Answer same = ask("GET", job + "/result", "If-None-Match: " + whole.header("ETag") + "\r\n");
  CHECK(same.status == 304);
  CHECK(same.body.empty());
  const Answer head = ask("HEAD", job + "/result");
  CHECK(head.status == 200);
  CHECK(head.body.empty());
  CHECK(head.header("Content-Length") == "22");
}

TEST_CASE_FIXTURE(Site, "multipart/form-data brings model, files and options") {
  open();
  const std::string body =
      "--x\r\nContent-Disposition: form-data; name=\"model\"; filename=\"m.gltf\"\r\n\r\n{}\r\n"
      "--x\r\nContent-Disposition: form-data; name=\"file\"; filename=\"m.bin\"\r\n\r\nbin\r\nbin\r\n"
      "--x\r\nContent-Disposition: form-data; name=\"options\"\r\n\r\n{\"texture_size\": 128}\r\n--x--\r\n";
  const Answer answer =
      ask("POST", "/v1/jobs", "Content-Type: multipart/form-data; boundary=x\r\nPrefer: wait=60\r\n", body);
  CHECK(answer.status == 200);
  CHECK(runner.last_task.options.texture_size == 128);
  REQUIRE(runner.last_task.files.size() == 1);
  CHECK(runner.last_task.files[0].name == "m.bin");
  CHECK(runner.last_task.files[0].bytes == 8);
}

TEST_CASE_FIXTURE(Site, "names of files may hold what ends other parameters") {
  open();
  const std::string body =
      "--x\r\nContent-Disposition: form-data; name=\"model\"; filename=\"m.gltf\"\r\n\r\n{}\r\n"
      "--x\r\nContent-Disposition: form-data; name=\"file\"; filename=\"a;b=1.bin\"\r\n\r\n1\r\n"
      "--x\r\nContent-Disposition: form-data; filename*=UTF-8''%C3%A9.bin; name=file2\r\n\r\n2\r\n--x--\r\n";
  CHECK(ask("POST", "/v1/jobs", "Content-Type: multipart/form-data; boundary=x\r\nPrefer: wait=60\r\n", body).status ==
        200);
  REQUIRE(runner.last_task.files.size() == 2);
  CHECK(runner.last_task.files[0].name == "a;b=1.bin");
  CHECK(runner.last_task.files[1].name == "\u00e9.bin");
}

TEST_CASE_FIXTURE(Site, "a connection whose request was refused is closed, as the answer says") {
  open();
  const auto socket = connect();
  send(socket, "GET /nothing HTTP/1.1\r\nHost: test\r\n\r\n");
  const Answer answer = receive(socket); // to the end of the stream
  CHECK(answer.status == 404);
  CHECK(answer.header("Connection") == "close");
  CHECK_FALSE(answer.header("Date").empty());
}

TEST_CASE_FIXTURE(Site, "an address may be long, but not endless") {
  open();
  CHECK(ask("GET", "/v1/jobs?cursor=" + std::string(20'000, 'A')).status == 400); // read, and no cursor
  const Answer answer = ask("GET", "/v1/jobs?cursor=" + std::string(32'100, 'A'));
  CHECK(answer.status == 414);
  CHECK(answer.body.find("uri-too-long") != std::string::npos);
}

TEST_CASE_FIXTURE(Site, "a body that is too large is 413, announced or not") {
  server::HttpSettings settings;
  settings.max_bytes = 1000;
  open(settings);
  const Answer announced = ask("POST", "/v1/jobs", glb, std::string(1001, 'x'));
  CHECK(announced.status == 413);
  CHECK(json::parse(announced.body)["type"] == "/problems/too-large");
  CHECK(json::parse(announced.body)["detail"].get<std::string>().find("1000") != std::string::npos);
  // In chunks: 1001 bytes are 3E9 in hexadecimal.
  const auto socket = connect();
  send(socket, "POST /v1/jobs HTTP/1.1\r\nHost: test\r\nConnection: close\r\n" + glb +
                   "Transfer-Encoding: chunked\r\n\r\n3E9\r\n" + std::string(1001, 'x') + "\r\n0\r\n\r\n");
  CHECK(receive(socket).status == 413);
  CHECK(std::filesystem::is_empty(directory.path / "spool"));
}

TEST_CASE_FIXTURE(Site, "what is no HTTP, no multipart or no body is a problem document") {
  open();
  for (const Answer& answer :
       {ask("GET", "/v1/jobs", "Bad Header\r\n"), ask("POST", "/v1/jobs", glb),
        ask("POST", "/v1/jobs", glb, "no model"),
        ask("POST", "/v1/jobs", "Content-Type: multipart/form-data; boundary=x\r\n", "--x\r\ncut off"),
        ask("GET", "/nothing"), ask("GET", "/v1/jobs", "Range: nonsense\r\n"), ask("PUT", "/livez")}) {
    CAPTURE(answer.head);
    if (answer.status == 200) continue; // a Range on a list has no meaning and may be ignored
    CHECK(answer.status >= 400);
    CHECK(answer.status < 500);
    CHECK(answer.header("Content-Type") == "application/problem+json");
    CHECK(json::parse(answer.body)["status"] == answer.status);
  }
}

TEST_CASE_FIXTURE(Site, "an upload that failed leaves nothing behind") {
  open();
  CHECK(ask("POST", "/v1/jobs", glb, "no model").status == 415);
  CHECK(ask("POST", "/v1/jobs?colour=red", glb, "glTF").status == 422);
  CHECK(std::filesystem::is_empty(directory.path / "spool"));
  CHECK(std::filesystem::is_empty(directory.path / "jobs"));
}

TEST_CASE_FIXTURE(Site, "a connection goes on after a DELETE without a body") {
  open();
  const std::string job = ask("POST", "/v1/jobs", glb, "glTF....").header("Location");
  REQUIRE_FALSE(job.empty());
  const auto socket = connect();
  send(socket, "DELETE " + job + " HTTP/1.1\r\nHost: test\r\n\r\n");
  std::string text(1 << 16, '\0'); // the answer is one write
  const auto got = ::recv(socket.get(), text.data(), text.size(), 0);
  REQUIRE(got > 12);
  CHECK(text.substr(9, 3) == "200");
  send(socket, "GET " + job + " HTTP/1.1\r\nHost: test\r\nConnection: close\r\n\r\n");
  CHECK(receive(socket).status == 200);
}

TEST_CASE_FIXTURE(Site, "clients that send nothing do not keep others out") {
  server::HttpSettings settings;
  settings.connections = 16;
  open(settings);
  std::vector<server::FileDescriptor> silent;
  for (int i = 0; i < 64; ++i) {
    silent.push_back(connect());
    send(silent.back(), "POST /v1/jobs HTTP/1.1\r\nHost: te");
  }
  CHECK(ask("GET", "/livez").body == "ok\n");
}

TEST_CASE_FIXTURE(Site, "events are streamed until the job is over") {
  open();
  const std::string job = ask("POST", "/v1/jobs", glb + "Prefer: wait=60\r\n", "glTF....").header("Location");
  const Answer events = ask("GET", job + "/events");
  CHECK(events.header("Content-Type") == "text/event-stream");
  CHECK(events.body.find("event: state") != std::string::npos);
  CHECK(events.body.find("\"state\":\"succeeded\"") != std::string::npos);
}

TEST_CASE_FIXTURE(Site, "the page and its parts are there") {
  open();
  const Answer page = ask("GET", "/");
  CHECK(page.header("Content-Type") == "text/html; charset=utf-8");
  CHECK(page.body.find("<title>orbis</title>") != std::string::npos);
  CHECK(ask("GET", "/orbis.js").status == 200);
  CHECK(ask("GET", "/orbis.css").status == 200);
}

TEST_CASE_FIXTURE(Site, "two servers do not share a port") {
  open();
  server::HttpSettings settings;
  settings.port = port;
  server::HttpServer second(router, blobs, metrics, settings);
  CHECK_THROWS_WITH_AS((void)second.bind(), doctest::Contains("the address is taken"), Error);
}
