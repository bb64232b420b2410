// What a calibration says: text, JSON, a page with pictures, a rig file.
#pragma once

#include <string>
#include <vector>

#include "clients/calibrate/findings.hpp"

namespace gyrotwin::calibration {

/// A fit and all that is told of it.
struct Calibration {
  std::string rig;                 ///< name
  std::vector<std::string> files;  ///< of the logs
  const std::vector<Stretch>& stretches;
  const Fit& fit;
  const Identifiability& known;
  std::vector<Finding> findings;
};

std::string text_of(const Calibration& calibration);
std::string json_of(const Calibration& calibration);
/// Residuals before and after, and what was found.
std::string page_of(const Calibration& calibration);

/// The rig file with what was identified.
/// @param document the rig file's text
std::string rig_file_of(const Calibration& calibration, const std::string& document);

}  // namespace gyrotwin::calibration
