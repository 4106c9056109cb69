#include "services/desktop_viewer/window/window.hpp"

#include <pcl/visualization/pcl_visualizer.h>
#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkProperty.h>
#include <vtkUnsignedCharArray.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

namespace eg::services {
namespace {

constexpr int kWidth = 1280;  // pixels
constexpr int kHeight = 800;
constexpr int kTextSize = 14;
constexpr int kLineHeight = 20;
constexpr int kMostKeys = 9;
constexpr double kBackground[3] = {0.067, 0.086, 0.114};
constexpr double kOn[3] = {0.90, 0.92, 0.95};
constexpr double kOff[3] = {0.38, 0.42, 0.48};
constexpr double kFieldOfView = 50.0 * std::numbers::pi / 180.0;
constexpr double kTightness = 0.8;  ///< a scene fills its bounding sphere by about so much
constexpr double kAmbient = 0.7;    ///< share of a surface's colour that needs no light: it has the room's already
constexpr double kDiffuse = 0.35;
const Eigen::Vector3d kFromAside(0.35, -0.75, 1.0);
const Eigen::Vector3d kFromAbove(0.0, -0.001, 1.0);

template <std::size_t N>
void add_cell(vtkCellArray& cells, const std::array<std::uint32_t, N>& corners) {
  cells.InsertNextCell(static_cast<vtkIdType>(N));
  for (const std::uint32_t corner : corners) cells.InsertCellPoint(corner);
}

vtkSmartPointer<vtkPolyData> poly_data_of(const io::PlyData& shape) {
  const auto data = vtkSmartPointer<vtkPolyData>::New();
  const auto points = vtkSmartPointer<vtkPoints>::New();
  for (const Eigen::Vector3f& vertex : shape.vertices) points->InsertNextPoint(vertex.x(), vertex.y(), vertex.z());
  data->SetPoints(points);
  const auto cells = vtkSmartPointer<vtkCellArray>::New();
  if (!shape.triangles.empty()) {
    for (const auto& triangle : shape.triangles) add_cell(*cells, triangle);
    data->SetPolys(cells);
  } else if (!shape.edges.empty()) {
    for (const auto& edge : shape.edges) add_cell(*cells, edge);
    data->SetLines(cells);
  } else {
    for (std::uint32_t i = 0; i < shape.vertices.size(); ++i) add_cell(*cells, std::array{i});
    data->SetVerts(cells);
  }
  const auto colours = vtkSmartPointer<vtkUnsignedCharArray>::New();
  colours->SetNumberOfComponents(3);
  for (const mapping::Colour& colour : shape.colours) colours->InsertNextTypedTuple(colour.data());
  data->GetPointData()->SetScalars(colours);
  if (!shape.normals.empty()) {
    const auto normals = vtkSmartPointer<vtkFloatArray>::New();
    normals->SetNumberOfComponents(3);
    for (const Eigen::Vector3f& normal : shape.normals) normals->InsertNextTypedTuple(normal.data());
    data->GetPointData()->SetNormals(normals);
  }
  return data;
}

}  // namespace

class Window::Impl {
 public:
  Impl() : viewer_("E-Graph SLAM") {
    viewer_.setSize(kWidth, kHeight);
    viewer_.setBackgroundColor(kBackground[0], kBackground[1], kBackground[2]);
    viewer_.setShowFPS(false);
    viewer_.setCameraFieldOfView(kFieldOfView);
    viewer_.registerKeyboardCallback([this](const pcl::visualization::KeyboardEvent& event) { on_key(event); });
    viewer_.registerMouseCallback([this](const pcl::visualization::MouseEvent& event) {
      if (event.getType() != pcl::visualization::MouseEvent::MouseMove) touched_ = true;
    });
  }

  void show(const Layer& layer) {
    Entry& entry = entry_of(layer);
    const std::string id = layer.name + "/" + layer.part;
    if (entry.ids.erase(id) > 0) viewer_.removeShape(id);
    if (layer.shape.vertices.empty()) return;
    entry.ids.insert(id);
    viewer_.addModelFromPolyData(poly_data_of(layer.shape), id);
    vtkActor& actor = actor_of(id);
    actor.SetVisibility(entry.visible ? 1 : 0);
    vtkProperty& property = *actor.GetProperty();
    property.SetPointSize(layer.width);
    property.SetLineWidth(layer.width);
    property.SetAmbient(layer.shape.triangles.empty() ? 1.0 : kAmbient);
    property.SetDiffuse(layer.shape.triangles.empty() ? 0.0 : kDiffuse);
    property.BackfaceCullingOn();  // one looks into rooms from outside
    if (!layer.in_view) return;
    for (const Eigen::Vector3f& vertex : layer.shape.vertices) bounds_.extend(vertex.cast<double>());
    grown_ = true;
  }

  void run_for(std::chrono::milliseconds time) {
    follow_growth();
    viewer_.spinOnce(static_cast<int>(time.count()));
  }
  [[nodiscard]] bool is_closed() const { return viewer_.wasStopped(); }

  bool save_picture(const std::filesystem::path& file) {
    follow_growth();
    viewer_.spinOnce(1, true);
    viewer_.saveScreenshot(file.string());
    return std::filesystem::exists(file);
  }

 private:
  struct Entry {
    std::string name;
    bool visible = true;
    std::set<std::string> ids{};  ///< of its parts, for PCLVisualizer
  };

  Entry& entry_of(const Layer& layer) {
    for (Entry& entry : entries_) {
      if (entry.name == layer.name) return entry;
    }
    entries_.push_back({layer.name, layer.visible});
    list(entries_.size() - 1);
    return entries_.back();
  }

  vtkActor& actor_of(const std::string& id) { return *vtkActor::SafeDownCast(viewer_.getShapeActorMap()->at(id)); }

  void toggle(std::size_t number) {
    Entry& entry = entries_[number];
    entry.visible = !entry.visible;
    for (const std::string& id : entry.ids) actor_of(id).SetVisibility(entry.visible ? 1 : 0);
    list(number);
  }

  /// Writes an entry into the list of keys, bright if it is on.
  void list(std::size_t number) {
    if (number >= kMostKeys) return;
    const Entry& entry = entries_[number];
    const std::string text = std::to_string(number + 1) + "  " + entry.name;
    const std::string id = "key " + entry.name;
    const double* colour = entry.visible ? kOn : kOff;
    const int y = kHeight - kLineHeight * (static_cast<int>(number) + 2);
    viewer_.removeShape(id);
    viewer_.addText(text, kLineHeight, y, kTextSize, colour[0], colour[1], colour[2], id);
  }

  void on_key(const pcl::visualization::KeyboardEvent& event) {
    if (!event.keyDown()) return;
    const int code = event.getKeyCode();
    const int number = code - '1';
    if (number >= 0 && number < static_cast<int>(std::min<std::size_t>(entries_.size(), kMostKeys))) {
      toggle(static_cast<std::size_t>(number));
    } else if (code == 't') {
      from_above_ = !from_above_;
      look_from(from_above_ ? kFromAbove : kFromAside);
    }
  }

  /// Once for all that has been added since: PCLVisualizer draws whenever its camera is moved.
  void follow_growth() {
    if (!touched_ && grown_) look_from(from_above_ ? kFromAbove : kFromAside);
    grown_ = false;
  }

  void look_from(const Eigen::Vector3d& direction) {
    if (bounds_.isEmpty()) return;
    const Eigen::Vector3d centre = bounds_.center();
    const double distance = bounds_.diagonal().norm() / 2.0 / std::sin(kFieldOfView / 2.0) * kTightness;
    const Eigen::Vector3d eye = centre + distance * direction.normalized();
    viewer_.setCameraPosition(eye.x(), eye.y(), eye.z(), centre.x(), centre.y(), centre.z(), 0.0, 0.0, 1.0);
    viewer_.getRenderWindow()->GetRenderers()->GetFirstRenderer()->ResetCameraClippingRange();
  }

  pcl::visualization::PCLVisualizer viewer_;
  std::vector<Entry> entries_;
  Eigen::AlignedBox3d bounds_;
  bool grown_ = false;
  bool touched_ = false;  ///< by the user: the view is theirs
  bool from_above_ = false;
};

Window::Window() : impl_(std::make_unique<Impl>()) {}
Window::~Window() = default;
void Window::show(const Layer& layer) { impl_->show(layer); }
void Window::run_for(std::chrono::milliseconds time) { impl_->run_for(time); }
bool Window::is_closed() const { return impl_->is_closed(); }
bool Window::save_picture(const std::filesystem::path& file) { return impl_->save_picture(file); }

}  // namespace eg::services
