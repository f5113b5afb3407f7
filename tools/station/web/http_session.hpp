// One HTTP/1.1 connection; pipelined requests wait. Owns the stream. Closes itself on a fault,
// timeout or size limit. Runs on the io thread; pending operations share ownership.
#pragma once

#include <boost/asio/steady_timer.hpp>
#include <deque>
#include <memory>
#include <string>

#include "bridge/net/byte_stream.hpp"
#include "tools/station/web/site.hpp"

namespace fieldcast::web {

struct HttpLimits {
  std::size_t header_bytes = 8 * 1024;
  std::size_t body_bytes = 64 * 1024;
  Duration idle = std::chrono::seconds{75};      // between two requests
  Duration header = std::chrono::seconds{10};    // from its first to its last byte
  Duration body = std::chrono::seconds{10};      // from the end of the header to the last byte
  Duration handler = std::chrono::seconds{60};   // for the station's response
  Duration progress = std::chrono::seconds{30};  // for a client to receive part of the response
  Duration linger = std::chrono::seconds{1};     // for a client to receive the last response
};

struct LiveRequest {
  std::unique_ptr<ByteStream> stream;
  std::string head;  // request header, which the WebSocket library parses again
  Site::Upgrade who;
};

class HttpSession : public std::enable_shared_from_this<HttpSession> {
 public:
  // Must outlive the sessions.
  struct Server {
    boost::asio::io_context& io;
    Site& site;
    HttpLimits limits;
    // Returns an empty value if the WebSocket is allowed.
    std::function<std::optional<HttpResponse>(const Site::Upgrade&)> refuse_live;
    std::function<void(LiveRequest)> take_live;
    // Returns whether the request may be processed; `logged_in`: it has a valid login.
    std::function<bool(std::uint64_t id, bool logged_in)> work;
    std::function<void(std::uint64_t id)> wait;  // the response has ended
    std::function<void(std::uint64_t id)> gone;  // called once, when the stream is closed or taken
    std::uint64_t requests = 0;                  // responses
    std::uint64_t faults = 0;                    // invalid requests and timeouts
  };
  // `id`: id of the session in the server; `peer`: address without the port.
  HttpSession(Server& server, std::uint64_t id, std::unique_ptr<ByteStream> stream,
              std::string peer);
  HttpSession(const HttpSession&) = delete;
  HttpSession& operator=(const HttpSession&) = delete;
  ~HttpSession();

  void start();
  void close();  // immediately

 private:
  enum class State : std::uint8_t {
    kIdle,  // waits for the first byte of a request
    kRequest,
    kHandler,  // waits for the handler's response
    kResponse,
    kLinger,  // discards input, so that the client receives the last response
    kClosed,
  };
  struct Parser;

  void enter(State state, Duration limit);
  void on_late();
  void next_request();
  void read();
  void on_read(std::size_t count);
  void parse();
  void on_request();
  void upgrade(RawRequest& raw);
  void refuse(unsigned status, std::string_view error, std::string_view hint);
  void respond(HttpResponse response);
  void send(std::shared_ptr<const std::string> bytes);
  void write();
  void on_written(std::size_t count);
  void next_piece();
  void on_piece(std::uint64_t answer, Piece piece);
  void finish_response();

  Server& server_;
  const std::uint64_t id_;
  std::unique_ptr<ByteStream> stream_;
  const std::string peer_;
  State state_ = State::kIdle;
  Instant since_{};
  boost::asio::steady_timer timer_;
  std::unique_ptr<Parser> parser_;  // of the current request
  std::string received_;            // not parsed yet
  std::string room_;                // buffer of the next read
  bool reading_ = false, keep_alive_ = false, chunked_ = false;
  bool head_only_ = false;    // the request was HEAD: its response has no body
  std::uint64_t answer_ = 0;  // number of responses; detects a second reply of a handler
  // Source of the streamed body; null if there is none or it has ended.
  std::shared_ptr<const std::function<void(std::function<void(Piece)>)>> pieces_;
  std::deque<std::shared_ptr<const std::string>> unsent_;
  std::size_t sent_ = 0;  // bytes of the first buffer already sent
};

}  // namespace fieldcast::web
