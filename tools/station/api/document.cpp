// The installed documents, which the pages link to. They need no internet.
#include <algorithm>
#include <filesystem>

#include "config/files/file_reader.hpp"
#include "tools/station/api/api_routes.hpp"
#include "tools/station/api/base/exchange.hpp"

namespace fieldcast::web {
namespace {

constexpr std::size_t kMaxDocumentName = 64;  // bytes

bool is_document_name(std::string_view name) {
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-';
  };
  return name.size() <= kMaxDocumentName && name.ends_with(".md") &&
         std::ranges::all_of(name.substr(0, name.size() - 3), plain);
}

// PREFIX/share/doc/fieldcast/docs of the templates PREFIX/share/fieldcast/devices.
std::filesystem::path document_folder() {
  const std::filesystem::path templates = config::default_options().template_directories.front();
  return (templates / "../../doc/fieldcast/docs").lexically_normal();
}

}  // namespace

void show_document(const Api&, const HttpRequest& request, const Caller&, const Reply& reply) {
  if (auto fault = Parameters(request, {"name"}).fault()) return reply(*std::move(fault));
  const std::string name = request.parameter("name").value_or("");
  if (!is_document_name(name))
    return reply(error_response(400, "name: this is not the name of a document",
                                "such as station.md, of a-z, 0-9 and '-'"));
  auto text = config::disk_reader().read(document_folder() / name);
  if (!text)
    return reply(error_response(404, "this document is not installed",
                                "the package fieldcast has it in /usr/share/doc/fieldcast/docs"));
  HttpResponse response;
  response.content_type = "text/plain; charset=utf-8";
  response.body = *std::move(text);
  reply(std::move(response));
}

}  // namespace fieldcast::web
