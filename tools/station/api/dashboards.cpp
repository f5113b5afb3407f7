#include <fmt/format.h>

#include <charconv>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/base/json.hpp"
#include "core/base/message_text.hpp"
#include "tools/station/api/api_routes.hpp"
#include "tools/station/api/audit_note.hpp"
#include "tools/station/api/base/exchange.hpp"
#include "tools/station/api/body_limits.hpp"
#include "tools/station/dashboard/dashboard_document.hpp"
#include "tools/station/dashboard/dashboard_table.hpp"
#include "tools/station/dashboard/picture.hpp"

namespace fieldcast::web {

namespace {

HttpResponse unknown_name(std::string_view kind) {
  return error_response(404, fmt::format("there is no {} of this name", kind),
                        fmt::format("GET /api/{}s lists them", kind));
}

HttpResponse too_many(std::string_view kind, std::size_t most) {
  return error_response(409, fmt::format("there are {} {}s already", most, kind),
                        "delete one that is not used");
}

// A name in the query or in the body of a request.
Checked<std::string> checked_name(std::optional<std::string> name) {
  if (name && is_dashboard_name(*name)) return *std::move(name);
  return tl::make_unexpected(error_response(400, "name: this is not a name",
                                            "1 to 64 of a-z, 0-9 and '-', the first not '-'"));
}

Checked<std::int64_t> checked_version(const nlohmann::json& body) {
  const auto found = body.find("base");
  if (found != body.end() && found->is_number_unsigned() && found->get<std::uint64_t>() < kMaxExact)
    return found->get<std::int64_t>();
  return tl::make_unexpected(
      error_response(400, "base: this is not a version",
                     "give the version that was changed; 0 for a new dashboard"));
}

std::string faults_json(const DashboardFaults& faults) {
  return json_array(faults, [](std::string& out, const DashboardFault& fault) {
    out += JsonObject()
               .add("place", fault.place)
               .add("what", fault.what)
               .add("allowed", fault.allowed)
               .take();
  });
}

JsonObject head_of(const StoredDocument& document) {
  JsonObject json;
  json.add("name", document.name)
      .add("version", document.version)
      .add("saved_by", document.saved_by)
      .add("saved_ms", document.saved_at);
  return json;
}

std::string dashboard_json(const StoredDocument& document) {
  return head_of(document).add("title", document.title).take();
}

std::string picture_json(const StoredPicture& picture) {
  return head_of(picture.document)
      .add("type", picture.type)
      .add("width", picture.width)
      .add("height", picture.height)
      .add("bytes", picture.bytes)
      .take();
}

}  // namespace

void list_dashboards(const Api& api, const HttpRequest& request, const Caller&,
                     const Reply& reply) {
  if (auto fault = Parameters(request, {}).fault()) return reply(*std::move(fault));
  api.database->respond(
      [compress = request.accepts_gzip](SqlConnection& connection) {
        const auto append = [](std::string& out, const StoredDocument& document) {
          out += dashboard_json(document);
        };
        return json_response(
            JsonObject()
                .add_json("dashboards", json_array(DashboardTable(connection).list(), append))
                .take(),
            compress);
      },
      reply);
}

void show_dashboard(const Api& api, const HttpRequest& request, const Caller&, const Reply& reply) {
  const Parameters parameters(request, {"name", "version"});
  if (auto fault = parameters.fault()) return reply(*std::move(fault));
  auto name = checked_name(request.parameter("name"));
  if (!name) return reply(std::move(name.error()));
  const auto version = parameters.number("version", 1, UINT32_MAX, 0);
  if (!version) return reply(version.error());
  api.database->respond(
      [name = *name, version = *version,
       compress = request.accepts_gzip](SqlConnection& connection) {
        const auto found =
            DashboardTable(connection)
                .find(name, version == 0 ? std::nullopt : std::optional<std::int64_t>(version));
        if (!found) return unknown_name("dashboard");
        return json_response(head_of(*found).add("text", found->content).take(), compress);
      },
      reply);
}

void check_dashboard_text(const Api&, const HttpRequest& request, const Caller&,
                          const Reply& reply) {
  const auto body = body_of(request);
  if (!body) return reply(body.error());
  if (auto fault = unknown_member(*body, {"text"})) return reply(*std::move(fault));
  const auto text = text_in(*body, "text", kMaxDashboardBody);
  if (!text)
    return reply(error_response(400, "text: this is not a text", "see docs/dashboards.md"));
  const auto head = check_dashboard(*text);
  reply(json_response(JsonObject()
                          .add_json("faults", faults_json(head ? DashboardFaults{} : head.error()))
                          .take()));
}

void save_dashboard(const Api& api, const HttpRequest& request, const Caller& caller,
                    const Reply& reply) {
  const auto body = body_of(request);
  if (!body) return reply(body.error());
  if (auto fault = unknown_member(*body, {"text", "base"})) return reply(*std::move(fault));
  const auto base = checked_version(*body);
  if (!base) return reply(base.error());
  auto text = text_in(*body, "text", kMaxDashboardBody);
  if (!text)
    return reply(error_response(400, "text: this is not a text", "see docs/dashboards.md"));
  const auto head = check_dashboard(*text);
  if (!head) {
    const DashboardFault& first = head.error().front();
    return reply(error_response(400, fmt::format("{}: {}", first.place, first.what),
                                "allowed: " + first.allowed));
  }
  StoredDocument document{.name = head->name,
                          .title = head->title,
                          .version = *base + 1,
                          .content = *std::move(text),
                          .saved_by = caller.user,
                          .saved_at = api.now()};
  const Reply done = noting(api, caller, "save dashboard", document.name, reply);
  api.database->respond_changing(
      [document = std::move(document)](SqlConnection& connection) {
        DashboardTable table(connection);
        if (table.save(document)) return json_response(dashboard_json(document));
        const auto newest = table.find(document.name, std::nullopt);
        if (!newest && document.version == 1)
          return too_many("dashboard", DashboardTable::kMaxDashboards);
        return error_response(
            409,
            newest ? fmt::format("{} has saved version {} of this dashboard", newest->saved_by,
                                 newest->version)
                   : "this dashboard was deleted",
            newest ? "load it, repeat your change and save again" : "save it with base 0");
      },
      done);
}

void delete_dashboard(const Api& api, const HttpRequest& request, const Caller& caller,
                      const Reply& reply) {
  const auto body = body_of(request);
  if (!body) return reply(body.error());
  if (auto fault = unknown_member(*body, {"name", "base"})) return reply(*std::move(fault));
  const auto name = checked_name(text_in(*body, "name", 64));
  if (!name) return reply(name.error());
  const auto base = checked_version(*body);
  if (!base) return reply(base.error());
  api.database->respond_changing(
      [name = *name, base = *base](SqlConnection& connection) {
        DashboardTable table(connection);
        if (table.remove(name, base)) return json_response(JsonObject().take());
        if (!table.find(name, std::nullopt)) return unknown_name("dashboard");
        return error_response(409, "a newer version of this dashboard was saved",
                              "load it before you delete it");
      },
      noting(api, caller, "delete dashboard", *name, reply));
}

void list_pictures(const Api& api, const HttpRequest& request, const Caller&, const Reply& reply) {
  if (auto fault = Parameters(request, {}).fault()) return reply(*std::move(fault));
  api.database->respond(
      [compress = request.accepts_gzip](SqlConnection& connection) {
        const auto append = [](std::string& out, const StoredPicture& picture) {
          out += picture_json(picture);
        };
        return json_response(
            JsonObject()
                .add_json("pictures", json_array(PictureTable(connection).list(), append))
                .take(),
            compress);
      },
      reply);
}

namespace {

HttpResponse file_response(const StoredPicture& picture, const std::string& known) {
  HttpResponse response;
  const std::string etag =
      fmt::format("\"{}-{}\"", picture.document.name, picture.document.version);
  // Opened by itself, the picture is a document of this site: it may load and run nothing.
  response.headers = {
      {"content-security-policy", "default-src 'none'; frame-ancestors 'none'; sandbox"},
      {"cache-control", "private, no-cache"},
      {"etag", etag}};
  const PictureType type = picture.type == "svg" ? PictureType::kSvg : PictureType::kPng;
  response.content_type = content_type(type);
  if (known == etag)
    response.status = 304;
  else
    response.body = type == PictureType::kSvg ? picture.document.content
                                              : from_base64(picture.document.content);
  return response;
}

}  // namespace

void show_picture(const Api& api, const HttpRequest& request, const Caller&, const Reply& reply) {
  // `v` is for the browser only: a new version has a new address.
  if (auto fault = Parameters(request, {"name", "v"}).fault()) return reply(*std::move(fault));
  auto name = checked_name(request.parameter("name"));
  if (!name) return reply(std::move(name.error()));
  api.database->respond(
      [name = *name, known = request.if_none_match](SqlConnection& connection) {
        const auto found = PictureTable(connection).find(name);
        return found ? file_response(*found, known) : unknown_name("picture");
      },
      reply);
}

void save_picture(const Api& api, const HttpRequest& request, const Caller& caller,
                  const Reply& reply) {
  const auto body = body_of(request);
  if (!body) return reply(body.error());
  if (auto fault = unknown_member(*body, {"name", "data"})) return reply(*std::move(fault));
  const auto name = checked_name(text_in(*body, "name", 64));
  if (!name) return reply(name.error());
  const std::string bytes = from_base64(text_in(*body, "data", kMaxPictureBody).value_or(""));
  if (bytes.empty())
    return reply(error_response(400, "data: this is not base64", "the file in base64 (RFC 4648)"));
  auto picture = check_picture(bytes);
  if (!picture) return reply(error_response(400, picture.error(), "upload an SVG or a PNG"));
  StoredPicture stored{.document = {.name = *name, .saved_by = caller.user, .saved_at = api.now()},
                       .type = std::string(to_text(picture->type)),
                       .width = picture->width,
                       .height = picture->height,
                       .bytes = static_cast<std::int64_t>(picture->content.size())};
  stored.document.content = picture->type == PictureType::kSvg ? std::move(picture->content)
                                                               : to_base64(picture->content);
  const auto append = [](std::string& out, const std::string& text) {
    append_json_text(out, text);
  };
  api.database->respond_changing(
      [stored = std::move(stored),
       removed = json_array(picture->removed, append)](SqlConnection& connection) mutable {
        stored.document.version = PictureTable(connection).save(stored);
        if (stored.document.version == 0) return too_many("picture", PictureTable::kMaxPictures);
        return json_response(
            json_joined(picture_json(stored), JsonObject().add_json("removed", removed).take()));
      },
      noting(api, caller, "save picture", *name, reply));
}

void delete_picture(const Api& api, const HttpRequest& request, const Caller& caller,
                    const Reply& reply) {
  const auto body = body_of(request);
  if (!body) return reply(body.error());
  if (auto fault = unknown_member(*body, {"name"})) return reply(*std::move(fault));
  const auto name = checked_name(text_in(*body, "name", 64));
  if (!name) return reply(name.error());
  api.database->respond_changing(
      [name = *name](SqlConnection& connection) {
        return PictureTable(connection).remove(name) ? json_response(JsonObject().take())
                                                     : unknown_name("picture");
      },
      noting(api, caller, "delete picture", *name, reply));
}

}  // namespace fieldcast::web
