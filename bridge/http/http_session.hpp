// One HTTP/1.1 connection; pipelined requests wait. Owns the stream. Closes itself on a fault,
// timeout or size limit. Runs on the io thread; pending operations share ownership.
#pragma once

#include <boost/asio/steady_timer.hpp>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <tl/expected.hpp>

#include "bridge/http/http_message.hpp"
#include "bridge/net/byte_stream.hpp"

namespace fieldcast::web {

struct HttpLimits {
  std::size_t header_bytes = 8 * 1024;
  std::size_t body_bytes = 64 * 1024;
  std::size_t largest_body_bytes = 5 * 1024 * 1024;  // of requests for which the service allows it
  Duration idle = std::chrono::seconds{75};          // between two requests
  Duration header = std::chrono::seconds{10};        // from its first to its last byte
  Duration body = std::chrono::seconds{10};          // from the end of the header to the last byte
  Duration handler = std::chrono::seconds{60};       // for the service's response
  Duration progress = std::chrono::seconds{30};      // for a client to receive part of the response
  Duration response = std::chrono::hours{24};        // for a client to receive a whole response
  Duration linger = std::chrono::seconds{1};         // for a client to receive the last response
};

// Content of a server. All calls are on the io thread.
class HttpService {
 public:
  virtual ~HttpService() = default;
  // `reply` is called once, immediately or later.
  virtual void handle(RawRequest request, Reply reply) = 0;
  // Returns the response to a request that is not served; the connection ends with it.
  [[nodiscard]] virtual HttpResponse refusal(unsigned status, std::string_view error,
                                             std::string_view hint) const = 0;
  // Connections with a login have limits of their own.
  [[nodiscard]] virtual bool has_login(const RawRequest&) { return false; }
  // Returns the limit of the body of a request with this header; `usual` is that of the server.
  [[nodiscard]] virtual std::size_t body_limit(const RawRequest&, std::size_t usual) {
    return usual;
  }
  // Receives the stream of a WebSocket and its request header, to be parsed again.
  using TakeStream = std::function<void(std::unique_ptr<ByteStream>, std::string head)>;
  // A null function: handle() serves the request.
  [[nodiscard]] virtual tl::expected<TakeStream, HttpResponse> upgrade(const RawRequest&) {
    return TakeStream{};
  }
};

class HttpSession : public std::enable_shared_from_this<HttpSession> {
 public:
  // Must outlive the sessions.
  struct Server {
    boost::asio::io_context& io;
    HttpService& service;
    HttpLimits limits;
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
  void hand_over(const HttpService::TakeStream& take);
  void refuse(unsigned status, std::string_view error, std::string_view hint);
  void refuse_body();
  void respond(HttpResponse response);
  void respond_last(HttpResponse response);  // and end the connection
  void await_client();
  void send(std::shared_ptr<const std::string> bytes);
  void write();
  void on_written(std::size_t count);
  void next_piece();
  void on_piece(std::uint64_t number, Piece piece);
  void finish_response();

  Server& server_;
  const std::uint64_t id_;
  std::unique_ptr<ByteStream> stream_;
  const std::string peer_;
  State state_ = State::kIdle;
  Instant since_{}, response_ends_{};
  boost::asio::steady_timer timer_;
  std::unique_ptr<Parser> parser_;  // of the current request
  std::string received_;            // not parsed yet
  std::string room_;                // buffer of the next read
  bool reading_ = false, keep_alive_ = false, chunked_ = false;
  bool head_only_ = false;       // the request was HEAD: its response has no body
  std::uint64_t responses_ = 0;  // number of responses; detects a second reply of a handler
  // Source of the streamed body; null if there is none or it has ended.
  std::shared_ptr<const std::function<void(std::function<void(Piece)>)>> pieces_;
  std::deque<std::shared_ptr<const std::string>> unsent_;
  std::size_t sent_ = 0;  // bytes of the first buffer already sent
};

}  // namespace fieldcast::web
