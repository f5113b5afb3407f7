// The table of the routes that read and change a plant: method, path, access, handler. openapi.yaml
// describes each of them, and its schemas. All run on the io thread.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bridge/http/http_message.hpp"
#include "tools/station/api/administration.hpp"
#include "tools/station/api/base/database.hpp"
#include "tools/station/api/body_limits.hpp"
#include "tools/station/api/export.hpp"
#include "tools/station/live/client_message.hpp"
#include "tools/station/live/configuration_requests.hpp"
#include "tools/station/model/live_model.hpp"
#include "tools/station/notify/notifier.hpp"
#include "tools/station/report/report_spec.hpp"
#include "tools/station/web/route_table.hpp"

namespace fieldcast::web {

inline constexpr std::uint32_t kMaxListed = 10'000;  // channels of one response

// The whole catalogue as compressed JSON.
struct KeptCatalogue {
  std::shared_ptr<const std::string> json;
  std::uint64_t version = 0;
};

// What the handlers use; it must outlive the table. Pointers are null without a store or recorder.
struct Api {
  const LiveModel* model = nullptr;
  CommandSink* commands = nullptr;
  ConfigurationRequests* configurations = nullptr;
  Database* database = nullptr;
  const Store* store = nullptr;
  const Recorder* recorder = nullptr;
  Audit* audit = nullptr;
  Notifier* notifier = nullptr;                      // null if nobody is notified
  const std::vector<ReportSpec>* reports = nullptr;  // by schedule
  std::function<UtcTime()> now;
  std::function<std::vector<Metric>()> metrics;  // counters of the rest of the program
  std::shared_ptr<KeptCatalogue> catalogue = std::make_shared<KeptCatalogue>();
  std::shared_ptr<RunningExports> exports = std::make_shared<RunningExports>();
};

using ApiHandler = void(const Api& api, const HttpRequest& request, const Caller& caller,
                        const Reply& reply);

ApiHandler show_alarms, show_audit, show_bridges, show_buses, show_catalogue, show_channels,
    show_devices, show_history, show_interests, show_metrics, show_notifications, show_openapi,
    test_notification, show_plan, show_report, show_result, show_sessions, show_sites, show_users,
    export_history;
ApiHandler show_configuration, check_configuration, deploy_configuration, confirm_configuration,
    roll_back_configuration, show_configuration_versions, show_configuration_version,
    show_configuration_schema, show_device_templates, import_configuration, probe_device, scan_bus;
ApiHandler write_value, acknowledge_alarms, shelve_alarms, unshelve_alarms, maintain_device,
    end_session;
ApiHandler list_dashboards, show_dashboard, check_dashboard_text, save_dashboard, delete_dashboard,
    list_pictures, show_picture, save_picture, delete_picture;
ApiHandler list_reports, save_report, delete_report, show_document;

struct ApiRow {
  Method method;
  const char* path;
  Access access;
  ApiHandler* handler;
  bool needs_store = false;  // without a store: 404
  std::size_t body_bytes = kUsualBody;
};

inline constexpr ApiRow kApiRows[] = {
    {Method::kGet, "/metrics", Access::kViewer, show_metrics},
    {Method::kGet, "/api/alarms", Access::kViewer, show_alarms},
    {Method::kPost, "/api/alarms/acknowledge", Access::kOperator, acknowledge_alarms},
    {Method::kPost, "/api/alarms/maintenance", Access::kOperator, maintain_device},
    {Method::kPost, "/api/alarms/shelve", Access::kOperator, shelve_alarms},
    {Method::kPost, "/api/alarms/unshelve", Access::kOperator, unshelve_alarms},
    {Method::kGet, "/api/audit", Access::kOperator, show_audit, true},
    {Method::kGet, "/api/bridges", Access::kViewer, show_bridges},
    {Method::kGet, "/api/buses", Access::kViewer, show_buses},
    {Method::kGet, "/api/catalogue", Access::kViewer, show_catalogue},
    {Method::kGet, "/api/channels", Access::kViewer, show_channels},
    {Method::kPost, "/api/commands", Access::kOperator, write_value},
    {Method::kGet, "/api/commands/result", Access::kOperator, show_result},
    {Method::kGet, "/api/configuration", Access::kEngineer, show_configuration},
    {Method::kPost, "/api/configuration/check", Access::kEngineer, check_configuration, false,
     kMaxConfigurationBody},
    {Method::kPost, "/api/configuration/confirm", Access::kEngineer, confirm_configuration},
    {Method::kPost, "/api/configuration/deploy", Access::kEngineer, deploy_configuration, false,
     kMaxConfigurationBody},
    {Method::kPost, "/api/configuration/import", Access::kEngineer, import_configuration, false,
     kMaxConfigurationBody},
    {Method::kPost, "/api/configuration/probe", Access::kEngineer, probe_device, false,
     kMaxConfigurationBody},
    {Method::kPost, "/api/configuration/rollback", Access::kEngineer, roll_back_configuration},
    {Method::kPost, "/api/configuration/scan", Access::kEngineer, scan_bus},
    {Method::kGet, "/api/configuration/schema", Access::kEngineer, show_configuration_schema},
    {Method::kGet, "/api/configuration/templates", Access::kEngineer, show_device_templates},
    {Method::kGet, "/api/configuration/version", Access::kEngineer, show_configuration_version},
    {Method::kGet, "/api/configuration/versions", Access::kEngineer, show_configuration_versions},
    {Method::kGet, "/api/dashboard", Access::kViewer, show_dashboard, true},
    {Method::kGet, "/api/dashboards", Access::kViewer, list_dashboards, true},
    {Method::kPost, "/api/dashboards/check", Access::kEngineer, check_dashboard_text, false,
     kMaxDashboardBody},
    {Method::kPost, "/api/dashboards/delete", Access::kEngineer, delete_dashboard, true},
    {Method::kPost, "/api/dashboards/save", Access::kEngineer, save_dashboard, true,
     kMaxDashboardBody},
    {Method::kGet, "/api/devices", Access::kViewer, show_devices},
    {Method::kGet, "/api/document", Access::kViewer, show_document},
    {Method::kGet, "/api/export", Access::kViewer, export_history, true},
    {Method::kGet, "/api/history", Access::kViewer, show_history, true},
    {Method::kGet, "/api/interests", Access::kViewer, show_interests},
    {Method::kGet, "/api/notifications", Access::kOperator, show_notifications},
    {Method::kPost, "/api/notifications/test", Access::kEngineer, test_notification, true},
    {Method::kGet, "/api/openapi.yaml", Access::kViewer, show_openapi},
    {Method::kGet, "/api/picture", Access::kViewer, show_picture, true},
    {Method::kGet, "/api/pictures", Access::kViewer, list_pictures, true},
    {Method::kPost, "/api/pictures/delete", Access::kEngineer, delete_picture, true},
    {Method::kPost, "/api/pictures/save", Access::kEngineer, save_picture, true, kMaxPictureBody},
    {Method::kGet, "/api/plan", Access::kViewer, show_plan},
    {Method::kGet, "/api/report", Access::kViewer, show_report, true},
    {Method::kGet, "/api/reports", Access::kViewer, list_reports, true},
    {Method::kPost, "/api/reports/delete", Access::kOperator, delete_report, true},
    {Method::kPost, "/api/reports/save", Access::kOperator, save_report, true},
    {Method::kGet, "/api/sessions", Access::kViewer, show_sessions},
    {Method::kPost, "/api/sessions/end", Access::kOperator, end_session},
    {Method::kGet, "/api/sites", Access::kViewer, show_sites},
    {Method::kGet, "/api/users", Access::kOperator, show_users, true},
};

void add_routes(RouteTable& routes, Api api);

}  // namespace fieldcast::web
