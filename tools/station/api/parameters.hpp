// The parameters of a request, read and checked. What is wrong becomes the response that refuses
// the request: it names the parameter, what came and what is wanted. Pure: the time is handed in.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "core/base/time.hpp"
#include "core/model/channel_path.hpp"
#include "core/model/pattern.hpp"
#include "tools/station/web/http_message.hpp"

namespace fieldcast::web {

template <class T>
using Checked = tl::expected<T, HttpResponse>;

inline constexpr Duration kOneDay = std::chrono::hours{24};

class Parameters {
 public:
  // `known`: every name that the resource takes. The request outlives it.
  Parameters(const HttpRequest& request, std::initializer_list<std::string_view> known)
      : request_(request), known_(known) {}

  // The response that refuses a name that is not known, or one that came twice and may not.
  [[nodiscard]] std::optional<HttpResponse> fault(std::string_view may_repeat = {}) const;

  // Each has a value for a parameter that is missing.
  [[nodiscard]] Checked<std::uint32_t> number(std::string_view name, std::uint32_t least,
                                              std::uint32_t most, std::uint32_t missing) const;
  [[nodiscard]] Checked<Pattern> pattern(std::string_view name) const;  // missing: everything
  [[nodiscard]] Checked<bool> chosen(std::string_view name, std::string_view no,
                                     std::string_view yes) const;  // missing: no
  // Nothing: it is missing. At least `least`.
  [[nodiscard]] Checked<std::optional<Duration>> duration(std::string_view name,
                                                          Duration least) const;

  struct Span {
    UtcTime from, to;
  };
  // `from` and `to`; missing: `length` until now. REQUIRES of who asks: from < to.
  [[nodiscard]] Checked<Span> span(UtcTime now, Duration length) const;
  // Every value of that name; at least one, at most `most`, each once.
  [[nodiscard]] Checked<std::vector<ChannelPath>> channels(std::string_view name,
                                                           std::size_t most) const;

 private:
  [[nodiscard]] Checked<std::optional<UtcTime>> time(std::string_view name, UtcTime now) const;

  const HttpRequest& request_;
  const std::vector<std::string_view> known_;
};

}  // namespace fieldcast::web
