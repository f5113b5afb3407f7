// Reads and checks the parameters of a request; a fault becomes the response. Pure.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "bridge/http/http_message.hpp"
#include "core/base/time.hpp"
#include "core/model/channel_pattern.hpp"

namespace fieldcast::web {

template <class T>
using Checked = tl::expected<T, HttpResponse>;

inline constexpr Duration kOneDay = std::chrono::hours{24};

class Parameters {
 public:
  // `known`: all parameter names of the resource. The request must outlive this object.
  Parameters(const HttpRequest& request, std::initializer_list<std::string_view> known)
      : request_(request), known_(known) {}

  // Refuses an unknown name, or a repeated one other than `may_repeat`.
  [[nodiscard]] std::optional<HttpResponse> fault(std::string_view may_repeat = {}) const;

  // Each function returns the given default if the parameter is missing.
  [[nodiscard]] Checked<std::uint32_t> number(std::string_view name, std::uint32_t least,
                                              std::uint32_t most, std::uint32_t missing) const;
  [[nodiscard]] Checked<Pattern> pattern(std::string_view name) const;  // missing: all channels
  [[nodiscard]] Checked<bool> chosen(std::string_view name, std::string_view no,
                                     std::string_view yes) const;  // missing: `no`
  // Empty if the parameter is missing. Refuses less than `least`.
  [[nodiscard]] Checked<std::optional<Duration>> duration(std::string_view name,
                                                          Duration least) const;

  struct Span {
    UtcTime from, to;
  };
  // Reads `from` and `to`; the default is the last `length` before `now`. Refuses from >= to.
  [[nodiscard]] Checked<Span> span(UtcTime now, Duration length) const;
  // Returns 1 to `most` values of that name; refuses duplicates.
  [[nodiscard]] Checked<std::vector<ChannelPath>> channels(std::string_view name,
                                                           std::size_t most) const;

 private:
  [[nodiscard]] Checked<std::optional<UtcTime>> time(std::string_view name, UtcTime now) const;

  const HttpRequest& request_;
  const std::vector<std::string_view> known_;
};

// Refuses a member of a JSON body that is not in `known`.
[[nodiscard]] std::optional<HttpResponse> unknown_member(
    const nlohmann::json& object, std::initializer_list<std::string_view> known);

// bytes; longer bodies are compressed if the client accepts gzip
inline constexpr std::size_t kWorthCompressing = 2048;
[[nodiscard]] HttpResponse json_response(std::string json, bool compress = false);
[[nodiscard]] HttpResponse no_store();

[[nodiscard]] std::string_view openapi_text();

}  // namespace fieldcast::web
