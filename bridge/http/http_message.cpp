#include "bridge/http/http_message.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>

#include "bridge/base/check.hpp"
#include "core/base/json.hpp"

namespace fieldcast::web {

namespace {

constexpr std::size_t kMaxParameters = 64;

constexpr std::array kMethods{std::pair{Method::kGet, std::string_view("GET")},
                              std::pair{Method::kPost, std::string_view("POST")},
                              std::pair{Method::kDelete, std::string_view("DELETE")}};

std::optional<unsigned> hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return std::nullopt;
}

// Percent escapes (RFC 3986, 2.1); in a query "+" is a space. Empty if invalid or a zero byte.
std::optional<std::string> decoded(std::string_view text, bool in_query) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    char c = text[i];
    if (c == '+' && in_query) c = ' ';
    if (c == '%') {
      if (text.size() - i < 3) return std::nullopt;
      const auto high = hex_digit(text[i + 1]);
      const auto low = hex_digit(text[i + 2]);
      if (!high || !low) return std::nullopt;
      c = static_cast<char>(*high * 16 + *low);
      i += 2;
    }
    if (c == '\0') return std::nullopt;
    out += c;
  }
  return out;
}

}  // namespace

std::string_view to_text(Method method) {
  return std::ranges::find(kMethods, method, &decltype(kMethods)::value_type::first)->second;
}

std::optional<Method> method_from(std::string_view text) {
  const auto found = std::ranges::find(kMethods, text, &decltype(kMethods)::value_type::second);
  if (found == kMethods.end()) return std::nullopt;
  return found->first;
}

std::optional<std::string> HttpRequest::parameter(std::string_view name) const {
  const auto found = std::ranges::find(query, name, &TextPairs::value_type::first);
  if (found == query.end()) return std::nullopt;
  return found->second;
}

std::vector<std::string> HttpRequest::parameters(std::string_view name) const {
  std::vector<std::string> values;
  for (const auto& [key, value] : query) {
    if (key == name) values.push_back(value);
  }
  return values;
}

HttpResponse error_response(unsigned status, std::string_view error, std::string_view hint) {
  HttpResponse response;
  response.status = status;
  response.body = JsonObject().add("error", error).add("hint", hint).take();
  return response;
}

std::optional<Target> parse_target(std::string_view text) {
  if (!text.starts_with('/')) return std::nullopt;
  const std::size_t mark = text.find('?');
  auto path = decoded(text.substr(0, mark), false);
  if (!path) return std::nullopt;
  Target target{std::move(*path), {}};
  std::string_view rest = mark == text.npos ? std::string_view() : text.substr(mark + 1);
  while (!rest.empty()) {
    const std::string_view one = rest.substr(0, rest.find('&'));
    rest.remove_prefix(std::min(rest.size(), one.size() + 1));
    if (one.empty()) continue;
    const std::size_t equals = std::min(one.find('='), one.size());
    auto key = decoded(one.substr(0, equals), true);
    auto value = decoded(one.substr(std::min(one.size(), equals + 1)), true);
    if (!key || !value || target.query.size() == kMaxParameters) return std::nullopt;
    target.query.emplace_back(std::move(*key), std::move(*value));
  }
  return target;
}

namespace {

constexpr std::pair<unsigned, std::string_view> kReasons[] = {
    {200, "OK"},
    {202, "Accepted"},
    {204, "No Content"},
    {304, "Not Modified"},
    {400, "Bad Request"},
    {401, "Unauthorized"},
    {403, "Forbidden"},
    {404, "Not Found"},
    {405, "Method Not Allowed"},
    {408, "Request Timeout"},
    {409, "Conflict"},
    {413, "Content Too Large"},
    {415, "Unsupported Media Type"},
    {421, "Misdirected Request"},
    {422, "Unprocessable Content"},
    {426, "Upgrade Required"},
    {429, "Too Many Requests"},
    {431, "Request Header Fields Too Large"},
    {500, "Internal Server Error"},
    {501, "Not Implemented"},
    {503, "Service Unavailable"},
    {504, "Gateway Timeout"},
};

bool one_line(std::string_view text) {
  for (const char c : text) {
    if (c == '\r' || c == '\n' || c == '\0') return false;
  }
  return true;
}

// "Sun, 06 Nov 1994 08:49:37 GMT"
std::string http_date(UtcTime at) {
  return fmt::format("{:%a, %d %b %Y %H:%M:%S GMT}", fmt::gmtime(at.nanoseconds / 1'000'000'000));
}

}  // namespace

std::string_view reason_of(unsigned status) {
  for (const auto& [code, reason] : kReasons) {
    if (code == status) return reason;
  }
  return "Other";
}

bool has_no_body(unsigned status) { return status == 204 || status == 304 || status < 200; }

std::string response_head(const HttpResponse& response, const HeadOptions& options) {
  std::string head = fmt::format("HTTP/1.1 {} {}\r\n", response.status, reason_of(response.status));
  const auto add = [&head](std::string_view name, std::string_view value) {
    if (one_line(name) && one_line(value)) head += fmt::format("{}: {}\r\n", name, value);
  };
  add("date", http_date(options.date));
  add("connection", options.keep_alive ? "keep-alive" : "close");
  if (!has_no_body(response.status)) {
    add("content-type", response.content_type);
    if (options.chunked) add("transfer-encoding", "chunked");
    if (options.length) add("content-length", std::to_string(*options.length));
  }
  for (const auto& [name, value] : response.headers) add(name, value);
  head += "\r\n";
  return head;
}

namespace {

constexpr int kGzip = 15 + 16;  // the largest window; + 16 selects the gzip header
constexpr std::size_t kPiece = 32 * 1024;

}  // namespace

struct GzipPieces::State {
  State() {
    FIELDCAST_CHECK(deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, kGzip, 8, Z_DEFAULT_STRATEGY) ==
                    Z_OK);
  }
  ~State() { deflateEnd(&stream); }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  std::string run(std::string_view text, int flush) {
    std::string out;
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
    stream.avail_in = static_cast<uInt>(text.size());
    do {
      const std::size_t had = out.size();
      out.resize(had + kPiece);
      stream.next_out = reinterpret_cast<Bytef*>(out.data() + had);
      stream.avail_out = kPiece;
      deflate(&stream, flush);
      out.resize(out.size() - stream.avail_out);
    } while (stream.avail_out == 0);
    return out;
  }

  z_stream stream{};
};

GzipPieces::GzipPieces() : state_(std::make_unique<State>()) {}
GzipPieces::~GzipPieces() = default;
std::string GzipPieces::put(std::string_view text) { return state_->run(text, Z_NO_FLUSH); }
std::string GzipPieces::finish() { return state_->run({}, Z_FINISH); }

std::string packed(std::string_view text) {
  GzipPieces pieces;
  std::string out = pieces.put(text);
  out += pieces.finish();
  return out;
}

std::string unpacked(std::string_view gzip) {
  z_stream stream{};
  FIELDCAST_CHECK(inflateInit2(&stream, kGzip) == Z_OK);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(gzip.data()));
  stream.avail_in = static_cast<uInt>(gzip.size());
  std::string out;
  for (int code = Z_OK; code == Z_OK;) {
    const std::size_t had = out.size();
    out.resize(had + kPiece);
    stream.next_out = reinterpret_cast<Bytef*>(out.data() + had);
    stream.avail_out = kPiece;
    code = inflate(&stream, Z_NO_FLUSH);
    out.resize(out.size() - stream.avail_out);
  }
  inflateEnd(&stream);
  return out;
}

}  // namespace fieldcast::web
