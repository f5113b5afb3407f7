#pragma once

#include "config/document/map_reader.hpp"
#include "core/model/spec.hpp"

namespace fieldcast::config {

[[nodiscard]] const Rows<BridgeSpec>& bridge_rows();
[[nodiscard]] const Rows<BridgeSpec>& identity_rows();
[[nodiscard]] const Rows<StandbySpec>& standby_rows();
[[nodiscard]] const Rows<DdsSpec>& dds_rows();
[[nodiscard]] const Rows<DdsSite>& site_rows();  // of a station
[[nodiscard]] const Rows<LogSpec>& log_rows();
[[nodiscard]] const Rows<StoreSpec>& store_rows();
[[nodiscard]] const Rows<MetricsSpec>& metrics_rows();
[[nodiscard]] const Rows<ConfigureSpec>& configure_rows();
[[nodiscard]] const Rows<ProgramSpec>& program_rows();
[[nodiscard]] const Rows<EngineersSpec>& engineer_rows();
[[nodiscard]] const Rows<EngineerPortSpec>& engineer_port_rows();
[[nodiscard]] const Rows<ModulesSpec>& module_rows();

}  // namespace fieldcast::config
