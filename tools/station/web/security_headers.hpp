// What every response carries so that a browser trusts nothing but the station's own files. Pure.
#pragma once

#include <string>
#include <vector>

#include "tools/station/web/http_message.hpp"

namespace fieldcast::web {

class SecurityHeaders {
 public:
  // `embed`: the sites that may show /embed in a frame ("https://wiki.plant"); nobody else may,
  // and nothing else may be shown in one.
  SecurityHeaders(bool tls, const std::vector<std::string>& embed);

  // Headers that the response has already stay.
  void add_to(HttpResponse& response, const std::string& path) const;

 private:
  const bool tls_;
  std::string policy_, embed_policy_;
};

}  // namespace fieldcast::web
