// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/rigs.h"

#include <Eigen/Geometry>
#include <set>

#include "common/base/error.h"
#include "common/config/yaml_value.h"

namespace coslam {
namespace {

std::vector<std::string> read_names(const YamlValue& cameras) {
  std::vector<std::string> names;
  std::set<std::string> once;
  for (const YamlValue& item : cameras.items()) {
    names.push_back(item.text());
    if (!once.insert(names.back()).second) item.fail("'" + names.back() + "' is in the rig twice");
  }
  if (names.size() < 2) cameras.fail("a rig has at least two cameras");
  return names;
}

// T_cn_cnm1: four rows of four numbers.
Rigid3 read_matrix(const YamlValue& value) {
  const auto rows = value.items();
  if (rows.size() != 4) value.fail("a transform is four rows of four numbers");
  Eigen::Matrix4d m;
  for (int row = 0; row < 4; ++row) {
    const std::vector<double> numbers = rows[static_cast<std::size_t>(row)].numbers();
    if (numbers.size() != 4) rows[static_cast<std::size_t>(row)].fail("a transform is four rows of four numbers");
    for (int column = 0; column < 4; ++column) m(row, column) = numbers[static_cast<std::size_t>(column)];
  }
  const Eigen::Matrix3d rotation = m.topLeftCorner<3, 3>();
  constexpr double kOff = 1e-3;
  const bool rigid = m.allFinite() && (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm() < kOff &&
                     rotation.determinant() > 0 && (m.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).norm() < kOff;
  if (!rigid) value.fail("this is not a rotation and a translation");
  return {Eigen::Quaterniond(rotation).normalized(), m.topRightCorner<3, 1>()};
}

std::vector<RigCamera> from_camchain(const YamlValue& rig, const std::vector<std::string>& names) {
  const YamlValue name = rig.at("kalibr");
  const std::filesystem::path file = rig.file().parent_path() / name.text();
  if (!std::filesystem::exists(file)) name.fail(file.string() + " does not exist");
  const YamlValue chain = YamlValue::load(file);
  std::vector<RigCamera> out;
  Rigid3 cam_from_first;
  for (std::size_t i = 1; i < names.size(); ++i) {
    cam_from_first = read_matrix(chain.at("cam" + std::to_string(i)).at("T_cn_cnm1")) * cam_from_first;
    if (!(cam_from_first.translation.norm() > 1e-6)) chain.fail("two cameras of a rig are not at one place");
    out.push_back({names[i], names.front(), cam_from_first});
  }
  return out;
}

}  // namespace

std::vector<RigCamera> read_rig(const YamlValue& rig) {
  rig.allow_only({"cameras", "cam_from_first", "kalibr"});
  const std::vector<std::string> names = read_names(rig.at("cameras"));
  if (rig.has("kalibr")) {
    if (rig.has("cam_from_first")) rig.fail("either cam_from_first or kalibr");
    return from_camchain(rig, names);
  }
  const YamlValue transforms = rig.at("cam_from_first");
  transforms.allow_only({names.begin() + 1, names.end()});
  std::vector<RigCamera> out;
  for (std::size_t i = 1; i < names.size(); ++i) {
    const YamlValue transform = transforms.at(names[i]);
    const std::vector<double> numbers = transform.numbers();
    try {
      out.push_back({names[i], names.front(), rig_transform(numbers)});
    } catch (const UserError& e) {
      transform.fail(e.what());
    }
  }
  return out;
}

std::vector<std::string> read_rig_texts(const YamlValue& rig) {
  std::vector<std::string> out;
  for (const RigCamera& camera : read_rig(rig)) out.push_back(text_of(camera));
  return out;
}

}  // namespace coslam
