// POST /api/configuration/import: converts a register list or the file of another program.
#include <nlohmann/json.hpp>

#include "core/base/json.hpp"
#include "core/base/message_text.hpp"
#include "tools/import/importer.hpp"
#include "tools/station/api/api_routes.hpp"
#include "tools/station/api/base/exchange.hpp"
#include "tools/station/dashboard/picture.hpp"

namespace fieldcast::web {

namespace {

constexpr std::size_t kMaxFile = 3u << 20, kMaxName = 128, kMaxProtocol = 64;  // bytes
constexpr std::size_t kMaxRows = 10'000;  // of each list in the response

Json body_of(const importing::Outcome& outcome) {
  std::vector<Json> moved, refusals;
  for (const importing::PointFate& row : outcome.rows) {
    const std::string from = row.at.empty() ? row.name : row.name + ' ' + row.at;
    if (row.fate == importing::Fate::kRefused && refusals.size() < kMaxRows)
      refusals.push_back({{"where", from}, {"why", row.words}});
    if (row.fate != importing::Fate::kRefused && moved.size() < kMaxRows)
      moved.push_back({{"from", from}, {"to", row.channel}, {"change", row.words}});
  }
  return {{"text", outcome.files.empty() ? "" : outcome.files.front().text},
          {"moved", moved},
          {"refusals", refusals},
          {"recognised", outcome.recognised},
          {"notes", outcome.notes}};
}

HttpResponse imported(const importing::InputFile& input, const importing::ImportOptions& options) {
  const auto outcome = importing::run_import({input}, options);
  if (!outcome)
    return error_response(400, outcome.error(), "fieldcast import has the same with more options");
  return json_response(body_of(*outcome).text());
}

}  // namespace

void import_configuration(const Api& api, const HttpRequest& request, const Caller&,
                          const Reply& reply) {
  const auto body = body_of(request);
  if (!body) return reply(body.error());
  const auto name = text_in(*body, "name", kMaxName);
  const auto content = text_in(*body, "content_base64", kMaxFile / 3 * 4);
  std::string bytes = content ? from_base64(*content) : std::string{};
  if (!name || bytes.empty())
    return reply(error_response(400, "the name or the content of the file is missing or too long",
                                "name, content_base64 and protocol; a file of at most 3 MiB"));
  importing::ImportOptions options;
  options.protocol = text_in(*body, "protocol", kMaxProtocol).value_or("");
  if (const auto fault = importing::fault_of_options(options))
    return reply(error_response(400, *fault, "leave the protocol out to guess it"));
  auto response = std::make_shared<HttpResponse>();
  const bool runs = api.configurations->run(
      [response, options, input = importing::InputFile{printable(*name), std::move(bytes)}] {
        *response = imported(input, options);
      },
      [response, reply] { reply(std::move(*response)); });
  if (!runs) reply(error_response(503, "too many requests wait", "try again later"));
}

}  // namespace fieldcast::web
