"""What a diagnosis hands over: a robot folder with everything fitted in it, its difference, and a table of figures."""
