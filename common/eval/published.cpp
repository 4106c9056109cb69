#include "common/eval/published.hpp"

#include <limits>

namespace eg::eval {
namespace {

constexpr double kFails = std::numeric_limits<double>::quiet_NaN();

std::vector<PublishedTable> make_tables() {
  using Measure = PublishedTable::Measure;
  return {
      {Measure::are_mean_deg,
       "Absolute rotation error, mean (degrees)",
       {"E-Graph", "Compass", "OPRE", "GOME", "ROVE", "OLRE", "ORB-SLAM2", "P-SLAM"},
       {{"office room 0", {0.11, 0.37, 0.18, 5.12, 29.11, 6.71, 0.40, 0.57}},
        {"office room 1", {0.22, 0.37, 0.32, kFails, 34.98, kFails, 2.30, 0.22}},
        {"office room 2", {0.39, 0.38, 0.33, 6.67, 60.54, 10.91, 0.51, 0.29}},
        {"office room 3", {0.24, 0.38, 0.21, 5.57, 10.67, 3.41, 0.36, 0.21}},
        {"living room 0", {0.44, 0.31, kFails, kFails, kFails, kFails, 0.97, 0.36}},
        {"living room 1", {0.24, 0.38, 0.97, 8.56, 26.74, 3.72, 0.22, 0.26}},
        {"living room 2", {0.36, 0.34, 0.49, 8.15, 39.71, 4.21, 0.83, 0.44}},
        {"living room 3", {0.36, 0.35, 1.34, kFails, kFails, kFails, 0.42, 0.27}},
        {"f3_stru_notex", {4.46, 1.96, 3.01, 4.07, kFails, 11.22, kFails, 4.71}},
        {"f3_stru_tex", {0.60, 2.92, 3.81, 4.71, 13.73, 8.21, 0.63, 2.83}},
        {"f3_l_cabinet", {1.45, 2.04, 36.34, 3.74, 28.41, 38.12, 2.79, 2.55}},
        {"f3_cabinet", {2.47, 2.48, 2.42, 2.59, kFails, kFails, 5.45, 1.18}}}},
      {Measure::ate_rmse_m,
       "Absolute trajectory error, RMSE (m)",
       {"E-Graph", "P-SLAM", "ORB-SLAM3"},
       {{"office room 0", {0.014, 0.068, 0.035}},
        {"office room 1", {0.013, 0.020, 0.091}},
        {"office room 2", {0.020, 0.011, 0.010}},
        {"office room 3", {0.011, 0.012, 0.096}},
        {"living room 0", {0.008, 0.006, 0.006}},
        {"living room 1", {0.006, 0.015, 0.206}},
        {"living room 2", {0.017, 0.020, 0.018}},
        {"living room 3", {0.021, 0.012, 0.019}},
        {"f1_360", {0.114, kFails, 0.108}},
        {"f1_room", {0.095, kFails, kFails}},
        {"f2_rpy", {0.002, 0.154, 0.003}},
        {"f2_xyz", {0.003, 0.009, 0.004}},
        {"f3_l_o_house", {0.012, 0.122, 0.009}},
        {"f3_stru_notex", {0.017, 0.025, kFails}},
        {"f3_l_cabinet", {0.058, 0.071, 0.072}}}},
      {Measure::ate_rmse_m,
       "Absolute trajectory error against systems on a graphics card, RMSE (m)",
       {"E-Graph", "BundleFusion", "ElasticFusion", "BadSLAM"},
       {{"f1_desk", {0.010, 0.016, 0.020, 0.017}},
        {"f2_xyz", {0.007, 0.011, 0.011, 0.011}},
        {"f3_l_o_house", {0.014, 0.022, 0.036, 0.017}}}},
      {Measure::ate_rmse_m,
       "Open-Structure, from the same observations: absolute trajectory error, RMSE (m)",
       {"baseline"},
       {{"office0", {0.0164}}, {"livingroom2", {0.130}}, {"corridor1", {0.106}}}},
      {Measure::are_mean_deg,
       "Open-Structure, from the same observations: absolute rotation error, mean (degrees)",
       {"baseline"},
       {{"office0", {0.20}}, {"livingroom2", {3.3}}, {"corridor1", {0.59}}}},
  };
}

}  // namespace

const std::vector<PublishedTable>& published_tables() {
  static const std::vector<PublishedTable> tables = make_tables();
  return tables;
}

std::vector<ResultTable> compare_with_published(const std::vector<SequenceResult>& results) {
  std::vector<ResultTable> tables;
  for (const PublishedTable& published : published_tables()) {
    const bool ate = published.measure == PublishedTable::Measure::ate_rmse_m;
    ResultTable table{published.title, ate ? 4 : 3, {"ours"}, {}};
    if (!ate) table.columns.emplace_back("(1st pose)");
    table.columns.insert(table.columns.end(), published.systems.begin(), published.systems.end());
    for (const SequenceResult& result : results) {
      const auto row = published.rows.find(result.sequence);
      if (row == published.rows.end()) continue;
      ResultRow line{result.sequence, {ate ? result.ate_rmse_m : result.are_mean_deg}};
      if (!ate) line.values.emplace_back(result.are_first_pose_deg);
      line.values.insert(line.values.end(), row->second.begin(), row->second.end());
      table.rows.push_back(std::move(line));
    }
    if (!table.rows.empty()) tables.push_back(std::move(table));
  }
  return tables;
}

}  // namespace eg::eval
