#include "clients/common/status_json.hpp"
#include "clients/ctl/report.hpp"

namespace gyrotwin {

std::string report_json(const Sighting& sighting) {
  const auto& [rig, reach, owner, controller, command, state, nominal_rotor_speed, mirror, link] =
      sighting;
  Json json = {{"rig", rig},
               {"reach", reach},
               {"owner", owner ? owner_json(*owner, lease_holder(sighting)) : Json(nullptr)},
               {"controller", controller ? daemon_json(*controller) : Json(nullptr)},
               {"mirror", mirror ? daemon_json(*mirror) : Json(nullptr)},
               {"link", link ? link_json(*link) : Json(nullptr)}};
  const std::optional<double> angle = tilt(sighting);
  json["tilt_rad"] = angle ? Json(*angle) : Json(nullptr);
  json["rotor_shares"] = rotor_shares(sighting);
  return json.dump(2) + '\n';
}

}  // namespace gyrotwin
