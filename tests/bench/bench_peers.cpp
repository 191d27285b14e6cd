// bench_peers.cpp -- CGAL's and Boost's part of the benchmarks; see peers.h.
#include <algorithm>
#include <numeric>
#include <vector>

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Spatial_sort_traits_adapter_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <CGAL/property_map.h>
#include <CGAL/spatial_sort.h>
#include <CGAL/version.h>
#include <boost/graph/compressed_sparse_row_graph.hpp>
#include <boost/graph/edge_list.hpp>
#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/kruskal_min_spanning_tree.hpp>
#include <boost/graph/prim_minimum_spanning_tree.hpp>
#include <boost/version.hpp>

#include "peers.h"

namespace
{

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_2;
using Points = std::vector<Point>;
using Delaunay = CGAL::Delaunay_triangulation_2<Kernel>;
using Height = CGAL::Triangulation_vertex_base_with_info_2<double, Kernel>;
using Surface =
    CGAL::Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<Height>>;

void *points(const ivec3 *pts, size_t n)
{
    auto *p = new Points;

    p->reserve(n);
    for (size_t i = 0; i < n; i++)
        p->emplace_back(pts[i].x, pts[i].y);
    return p;
}

void *triangulate(const void *p)
{
    const auto &pts = *static_cast<const Points *>(p);

    return new Delaunay(pts.begin(), pts.end());
}

void *merge(const void *t, const void *p)
{
    const auto &pts = *static_cast<const Points *>(p);
    auto *out = new Delaunay(*static_cast<const Delaunay *>(t));

    out->insert(pts.begin(), pts.end());
    return out;
}

size_t vertices(const void *t)
{
    return static_cast<const Delaunay *>(t)->number_of_vertices();
}

void *surface(const ivec3 *pts, size_t n)
{
    std::vector<std::pair<Point, double>> p;

    for (size_t i = 0; i < n; i++)
        p.emplace_back(Point(pts[i].x, pts[i].y), pts[i].z);
    return new Surface(p.begin(), p.end());
}

void locate(const void *s, const void *p, double *height)
{
    using Map = CGAL::Pointer_property_map<Point>::const_type;
    using Order = CGAL::Spatial_sort_traits_adapter_2<Kernel, Map>;
    const auto &dt = *static_cast<const Surface *>(s);
    const auto &pts = *static_cast<const Points *>(p);
    std::vector<size_t> order(pts.size());
    Surface::Face_handle hint;

    std::iota(order.begin(), order.end(), size_t(0));
    CGAL::spatial_sort(order.begin(), order.end(),
                       Order(CGAL::make_property_map(pts), Kernel()));
    for (size_t i : order) {
        const Point &q = pts[i];
        double w[3], sum = 0, h = 0;

        hint = dt.locate(q, hint);
        if (dt.is_infinite(hint)) {
            height[i] = 0;
            continue;
        }
        for (int k = 0; k < 3; k++) {
            const Point &a = hint->vertex(Surface::ccw(k))->point();
            const Point &b = hint->vertex(Surface::cw(k))->point();

            w[k] = (b.x() - a.x()) * (q.y() - a.y()) - (b.y() - a.y()) * (q.x() - a.x());
            sum += w[k];
        }
        for (int k = 0; k < 3; k++)
            h += w[k] * hint->vertex(k)->info();
        height[i] = h / sum;
    }
}

struct Length {
    double length;
};

// Prim reads a compressed graph, Kruskal a list of edges: the fastest of Boost's for each.
struct Graph {
    using Rows =
        boost::compressed_sparse_row_graph<boost::directedS, boost::no_property, Length>;
    using List = boost::adjacency_list<boost::vecS, boost::vecS, boost::undirectedS,
                                       boost::no_property, Length>;
    Rows rows;
    List list;
    std::vector<size_t> parent;
    std::vector<boost::graph_traits<List>::edge_descriptor> tree;
};

void *graph(uint32_t nv, const uint32_t (*edges)[2], const double *length, size_t n)
{
    std::vector<std::pair<size_t, size_t>> ends;
    std::vector<Length> len;
    auto *g = new Graph;

    for (size_t i = 0; i < n; i++) {
        ends.emplace_back(edges[i][0], edges[i][1]);
        ends.emplace_back(edges[i][1], edges[i][0]);
        len.push_back({length[i]});
        len.push_back({length[i]});
    }
    g->rows = Graph::Rows(boost::edges_are_unsorted_multi_pass, ends.begin(), ends.end(),
                          len.begin(), nv);
    g->list = Graph::List(nv);
    for (size_t i = 0; i < n; i++)
        boost::add_edge(edges[i][0], edges[i][1], Length{length[i]}, g->list);
    g->parent.resize(nv);
    g->tree.reserve(nv);
    return g;
}

void prim(void *p)
{
    auto &g = *static_cast<Graph *>(p);

    boost::prim_minimum_spanning_tree(
        g.rows, g.parent.data(), boost::weight_map(boost::get(&Length::length, g.rows)));
}

double kruskal(void *p)
{
    auto &g = *static_cast<Graph *>(p);
    double total = 0;

    g.tree.clear();
    boost::kruskal_minimum_spanning_tree(
        g.list, std::back_inserter(g.tree),
        boost::weight_map(boost::get(&Length::length, g.list)));
    for (const auto &e : g.tree)
        total += g.list[e].length;
    return total;
}

template <class T> void drop(void *p)
{
    delete static_cast<T *>(p);
}

} // namespace

extern "C" {
extern const peers peers_table;
const peers peers_table = {
    "CGAL " CGAL_VERSION_STR ", Boost " BOOST_LIB_VERSION,
    points,
    drop<Points>,
    triangulate,
    merge,
    vertices,
    drop<Delaunay>,
    surface,
    locate,
    drop<Surface>,
    graph,
    prim,
    kruskal,
    drop<Graph>,
};
}
