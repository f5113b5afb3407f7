// Security headers of every response: a browser accepts only files of the station. Pure.
#pragma once

#include <string>
#include <vector>

#include "tools/station/http/http_message.hpp"

namespace fieldcast::web {

class SecurityHeaders {
 public:
  // `embed`: the sites that may show /embed in a frame ("https://wiki.plant").
  SecurityHeaders(bool tls, const std::vector<std::string>& embed);

  // Keeps headers that the response already has.
  void add_to(HttpResponse& response, const std::string& path) const;

 private:
  const bool tls_;
  std::string policy_, embed_policy_;
};

}  // namespace fieldcast::web
