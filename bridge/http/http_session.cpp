#include "bridge/http/http_session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <utility>

#include "bridge/base/clock.hpp"
#include "bridge/http/http_guard.hpp"
#include "bridge/http/http_message.hpp"

namespace fieldcast::web {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using boost::system::error_code;

constexpr std::size_t kReadSize = 8 * 1024;          // size of one read
constexpr std::size_t kMaxLingerBytes = 256 * 1024;  // bytes discarded after the last response

std::string_view view(beast::string_view text) { return {text.data(), text.size()}; }

template <typename Fields>
std::string text_of(const Fields& fields, http::field name) {
  return std::string(view(fields[name]));
}

template <typename Request>
RawRequest raw_of(Request& request, const std::string& peer) {
  RawRequest raw;
  raw.method = std::string(view(request.method_string()));
  raw.target = std::string(view(request.target()));
  const auto hosts = request.equal_range(http::field::host);
  for (auto at = hosts.first; at != hosts.second; ++at) raw.hosts.emplace_back(view(at->value()));
  if (request.count(http::field::origin) == 1) raw.origin = text_of(request, http::field::origin);
  raw.content_type = text_of(request, http::field::content_type);
  raw.cookie = text_of(request, http::field::cookie);
  raw.accept = text_of(request, http::field::accept);
  raw.accept_encoding = text_of(request, http::field::accept_encoding);
  raw.if_none_match = text_of(request, http::field::if_none_match);
  raw.subprotocols = text_of(request, http::field::sec_websocket_protocol);
  raw.body = std::move(request.body());
  raw.peer = peer;
  return raw;
}

template <typename Fields>
std::size_t count_of(const Fields& fields) {
  return static_cast<std::size_t>(std::distance(fields.begin(), fields.end()));
}

// Serializes the header again for the WebSocket library.
template <typename Request>
std::string head_of(const Request& request) {
  std::string head =
      fmt::format("{} {} HTTP/1.1\r\n", view(request.method_string()), view(request.target()));
  for (const auto& field : request)
    head += fmt::format("{}: {}\r\n", view(field.name_string()), view(field.value()));
  return head + "\r\n";
}

}  // namespace

struct HttpSession::Parser {
  Parser(const HttpLimits& limits) {
    parser.header_limit(static_cast<std::uint32_t>(limits.header_bytes));
    parser.body_limit(std::max(limits.body_bytes, limits.long_body_bytes));
    parser.eager(true);
  }
  http::request_parser<http::string_body> parser;
  HeadCheck head;
  std::size_t fields = 0;  // number of header fields
  bool told_to_continue = false;
};

HttpSession::HttpSession(Server& server, std::uint64_t id, std::unique_ptr<ByteStream> stream,
                         std::string peer)
    : server_(server),
      id_(id),
      stream_(std::move(stream)),
      peer_(std::move(peer)),
      since_(steady_now()),
      timer_(server.io),
      room_(kReadSize, '\0') {}

HttpSession::~HttpSession() = default;

void HttpSession::start() {
  // a new client must send its first request within this limit
  enter(State::kIdle, server_.limits.header);
  parser_ = std::make_unique<Parser>(server_.limits);
  read();
}

void HttpSession::close() {
  if (state_ == State::kClosed) return;
  state_ = State::kClosed;
  timer_.cancel();
  pieces_.reset();
  if (stream_) stream_->close();
  const auto self = shared_from_this();  // the server releases its pointer
  server_.gone(id_);
}

void HttpSession::enter(State state, Duration limit) {
  state_ = state;
  since_ = steady_now();
  timer_.expires_after(std::chrono::duration_cast<std::chrono::steady_clock::duration>(limit));
  timer_.async_wait([self = shared_from_this(), began = since_](error_code cancelled) {
    if (!cancelled && self->since_ == began) self->on_late();
  });
}

void HttpSession::await_client() {
  enter(State::kResponse, std::min(server_.limits.progress, response_ends_ - steady_now()));
}

void HttpSession::on_late() {
  if (state_ == State::kClosed) return;
  if (state_ == State::kRequest)
    return refuse(408, "the request took too long", "send it without a pause");
  if (state_ == State::kHandler)
    return respond_last(server_.service.refusal(503, "the station is too busy", "try again later"));
  if (state_ != State::kIdle && state_ != State::kLinger) ++server_.faults;
  close();
}

void HttpSession::next_request() {
  parser_ = std::make_unique<Parser>(server_.limits);
  if (!received_.empty()) {
    enter(State::kRequest, server_.limits.header);
    return parse();
  }
  enter(State::kIdle, server_.limits.idle);
  read();
}

void HttpSession::read() {
  if (reading_) return;
  reading_ = true;
  stream_->read_some(asio::buffer(room_),
                     [self = shared_from_this()](error_code fault, std::size_t count) {
                       self->reading_ = false;
                       if (self->state_ == State::kClosed) return;
                       return fault ? self->close() : self->on_read(count);
                     });
}

void HttpSession::on_read(std::size_t count) {
  if (state_ == State::kLinger) {
    sent_ += count;
    return sent_ > kMaxLingerBytes ? close() : read();
  }
  if (state_ == State::kIdle) enter(State::kRequest, server_.limits.header);
  if (state_ != State::kRequest) return;  // too late: the session has closed or sends a response
  received_.append(room_, 0, count);
  parse();
}

void HttpSession::parse() {
  auto& parser = parser_->parser;
  if (parser_->head.size() == 0) {
    if (const auto fault = parser_->head.put(received_))
      return refuse(fault->status, fault->error, fault->hint);
  }
  while (parser_->head.size() > 0 && !received_.empty() && !parser.is_done()) {
    error_code fault;
    const std::size_t size = parser.is_header_done() ? received_.size() : parser_->head.size();
    const std::size_t used = parser.put(asio::const_buffer(received_.data(), size), fault);
    received_.erase(0, used);
    if (fault == http::error::need_more) break;
    if (fault == http::error::header_limit)
      return refuse(431, "the header is too long",
                    fmt::format("at most {} bytes", server_.limits.header_bytes));
    if (fault == http::error::body_limit)
      return refuse(413, "the body is too long", fmt::format("at most {} bytes", body_limit_));
    if (fault) return refuse(400, "no HTTP request", "send HTTP/1.1");
    if (parser.is_header_done() && parser_->fields == 0) {
      parser_->fields = count_of(parser.get());
      body_limit_ = server_.service.takes_long_body(raw_of(parser.get(), peer_))
                        ? server_.limits.long_body_bytes
                        : server_.limits.body_bytes;
      parser.body_limit(body_limit_);
      if (parser.content_length().value_or(0) > body_limit_)
        return refuse(413, "the body is too long", fmt::format("at most {} bytes", body_limit_));
      enter(State::kRequest, server_.limits.body);
    }
    if (used == 0) break;
  }
  // The parser appends trailer fields of a chunked body to the header, for example Host or Cookie.
  if (parser.is_done() && count_of(parser.get()) != parser_->fields)
    return refuse(400, "fields behind the body", "send them in the header");
  if (parser.is_done()) return on_request();
  // An incomplete header stays in received_.
  if (received_.size() > server_.limits.header_bytes)
    return refuse(431, "the header is too long",
                  fmt::format("at most {} bytes", server_.limits.header_bytes));
  if (parser.is_header_done() && !parser_->told_to_continue &&
      beast::iequals(parser.get()[http::field::expect], "100-continue")) {
    parser_->told_to_continue = true;
    const auto text = std::make_shared<const std::string>("HTTP/1.1 100 Continue\r\n\r\n");
    return stream_->write_some(asio::buffer(*text),
                               [self = shared_from_this(), text](error_code fault, std::size_t) {
                                 if (self->state_ == State::kRequest)
                                   fault ? self->close() : self->read();
                               });
  }
  read();
}

void HttpSession::on_request() {
  auto& request = parser_->parser.get();
  keep_alive_ = request.keep_alive();
  chunked_ = request.version() >= 11;
  const bool upgrades = beast::websocket::is_upgrade(request);
  RawRequest raw = raw_of(request, peer_);
  head_only_ = raw.method == "HEAD";
  if (upgrades) {
    auto take = server_.service.upgrade(raw);
    if (!take) return respond_last(std::move(take.error()));
    if (*take) return hand_over(*take);
  }
  parser_.reset();
  if (!server_.work(id_, server_.service.has_login(raw)))
    return respond_last(
        server_.service.refusal(503, "too many requests at a time", "try again later"));
  enter(State::kHandler, server_.limits.handler);
  server_.service.handle(
      std::move(raw), [weak = weak_from_this(), number = responses_](HttpResponse response) {
        const auto self = weak.lock();
        if (self && self->state_ == State::kHandler && self->responses_ == number)
          self->respond(std::move(response));
      });
}

void HttpSession::hand_over(const HttpService::TakeStream& take) {
  if (!received_.empty())
    return refuse(400, "bytes before the WebSocket is open", "wait for the response");
  std::string head = head_of(parser_->parser.get());
  state_ = State::kClosed;
  timer_.cancel();
  ++server_.requests;
  const auto self = shared_from_this();
  take(std::move(stream_), std::move(head));
  server_.gone(id_);
}

void HttpSession::refuse(unsigned status, std::string_view error, std::string_view hint) {
  ++server_.faults;
  chunked_ = true;
  respond_last(server_.service.refusal(status, error, hint));
}

void HttpSession::respond_last(HttpResponse response) {
  response.close = true;
  respond(std::move(response));
}

void HttpSession::respond(HttpResponse response) {
  ++responses_;
  ++server_.requests;
  response_ends_ = steady_now() + server_.limits.response;
  await_client();
  const bool streams = response.next != nullptr;
  if (response.close || (streams && !chunked_)) keep_alive_ = false;
  const std::shared_ptr<const std::string> body =
      response.shared_body ? std::move(response.shared_body)
                           : std::make_shared<const std::string>(std::move(response.body));
  const bool bare = has_no_body(response.status);
  HeadOptions options{read_clocks().to_utc(steady_now()), keep_alive_, std::nullopt,
                      streams && chunked_ && !bare};
  if (!streams && !bare) options.length = body->size();
  send(std::make_shared<const std::string>(response_head(response, options)));
  const bool sends_body = !bare && !std::exchange(head_only_, false);
  if (sends_body && !streams && !body->empty()) send(body);
  if (sends_body && streams)
    pieces_ = std::make_shared<const std::function<void(std::function<void(Piece)>)>>(
        std::move(response.next));
  write();
}

void HttpSession::send(std::shared_ptr<const std::string> bytes) {
  if (!bytes->empty()) unsent_.push_back(std::move(bytes));
}

void HttpSession::write() {
  if (unsent_.empty() && !pieces_) return finish_response();
  // The timer alone does not end it: each part that the client receives sets the timer again.
  if (steady_now() >= response_ends_) return on_late();
  if (unsent_.empty()) return next_piece();
  const auto bytes = unsent_.front();
  stream_->write_some(asio::buffer(bytes->data() + sent_, bytes->size() - sent_),
                      [self = shared_from_this(), bytes](error_code fault, std::size_t count) {
                        if (self->state_ != State::kResponse) return;
                        return fault ? self->close() : self->on_written(count);
                      });
}

void HttpSession::on_written(std::size_t count) {
  sent_ += count;
  if (sent_ >= unsent_.front()->size()) {
    unsent_.pop_front();
    sent_ = 0;
  }
  if (count > 0) await_client();
  write();
}

void HttpSession::next_piece() {
  const auto next = pieces_;  // keeps the function alive while it runs
  (*next)([weak = weak_from_this(), number = responses_](Piece piece) {
    if (const auto self = weak.lock()) self->on_piece(number, std::move(piece));
  });
}

void HttpSession::on_piece(std::uint64_t number, Piece piece) {
  if (state_ != State::kResponse || number != responses_ || !pieces_ || !unsent_.empty()) return;
  await_client();
  std::string bytes;
  if (!piece) {
    pieces_.reset();
    if (chunked_) bytes = "0\r\n\r\n";
  } else if (chunked_ && !piece->empty()) {
    bytes = fmt::format("{:x}\r\n{}\r\n", piece->size(), *piece);
  } else if (piece) {
    bytes = std::move(*piece);
  }
  send(std::make_shared<const std::string>(std::move(bytes)));
  // Post the call: a handler that always returns immediately would overflow the stack.
  asio::post(server_.io, [self = shared_from_this()] {
    if (self->state_ == State::kResponse) self->write();
  });
}

void HttpSession::finish_response() {
  server_.wait(id_);
  if (keep_alive_) return next_request();
  parser_.reset();
  received_.clear();
  stream_->end_sending();
  // Discard unread bytes first: otherwise TCP resets the connection and can drop the response.
  enter(State::kLinger, server_.limits.linger);
  read();
}

}  // namespace fieldcast::web
