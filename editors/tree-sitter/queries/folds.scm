[(param) (grid) (define) (function) (curve) (surface) (point) (vector) (metric) (geodesic)] @fold
