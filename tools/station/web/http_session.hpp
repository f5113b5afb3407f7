// One connection of a client: a request, its response, and again (HTTP/1.1, one request at a time;
// what a client sends ahead waits). Owns the stream. Ends itself at a fault or a limit of time or
// size. Lives on the io thread; shared with the operations under way.
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
  Duration header = std::chrono::seconds{10};    // from its first byte to its last
  Duration body = std::chrono::seconds{10};      // from the end of the header to its last byte
  Duration handler = std::chrono::seconds{60};   // for the station to answer
  Duration progress = std::chrono::seconds{30};  // for a client to take some of the response
  Duration linger = std::chrono::seconds{1};     // for a client to take the last response
};

// A connection that becomes a WebSocket.
struct LiveRequest {
  std::unique_ptr<ByteStream> stream;
  std::string head;  // the request's header, as it is to be read again by the WebSocket's library
  Site::Upgrade who;
};

class HttpSession : public std::enable_shared_from_this<HttpSession> {
 public:
  // What a session needs of its server; it outlives the sessions.
  struct Server {
    boost::asio::io_context& io;
    Site& site;
    HttpLimits limits;
    // Why this caller gets no WebSocket now; nothing: it gets one.
    std::function<std::optional<HttpResponse>(const Site::Upgrade&)> refuse_live;
    std::function<void(LiveRequest)> take_live;
    // Whether the station may work on the request that came; `logged_in`: with a valid login.
    std::function<bool(std::uint64_t id, bool logged_in)> work;
    std::function<void(std::uint64_t id)> wait;  // the response ended
    std::function<void(std::uint64_t id)> gone;  // once, when the stream is closed or taken
    std::uint64_t requests = 0;                  // that were answered
    std::uint64_t faults = 0;                    // bytes that were no request, and times run out
  };
  // `id`: of the server, for its functions; `peer`: the address without the port.
  HttpSession(Server& server, std::uint64_t id, std::unique_ptr<ByteStream> stream,
              std::string peer);
  HttpSession(const HttpSession&) = delete;
  HttpSession& operator=(const HttpSession&) = delete;
  ~HttpSession();

  void start();
  void close();  // at once

 private:
  enum class State : std::uint8_t {
    kIdle,      // waits for the first byte of a request
    kRequest,   // reads one
    kHandler,   // waits for the station's answer
    kResponse,  // sends it
    kLinger,    // reads away what still comes, so that the client gets the last response
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
  std::unique_ptr<Parser> parser_;  // of the request under way
  std::string received_;            // and not parsed yet
  std::string room_;                // for the next read
  bool reading_ = false, keep_alive_ = false, chunked_ = false;
  bool head_only_ = false;    // the request was HEAD: its response has no body
  std::uint64_t answer_ = 0;  // counts responses: a handler's second reply is told by it
  // Of the response under way; null: its body does not come in pieces, or has ended.
  std::shared_ptr<const std::function<void(std::function<void(Piece)>)>> pieces_;
  std::deque<std::shared_ptr<const std::string>> unsent_;
  std::size_t sent_ = 0;  // bytes of the first of them
};

}  // namespace fieldcast::web
